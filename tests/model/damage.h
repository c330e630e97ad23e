#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "base/result.h"
#include "model/test_folder.h"

namespace surfcast::model {

using Bytes = std::vector<std::byte>;

Bytes content_of(const std::filesystem::path& path);

/// Corrects the size and the checksums of header and tables, as an attacker would. `directory`: the offset of the
/// tables.
void repair_tables(Bytes& bytes, size_t directory);
/// Corrects the checksum of each block, wherever the tables of the undamaged file `whole` have it.
void repair_blocks(Bytes& bytes, const Bytes& whole);

/// Reads everything in a file.
using ReadAll = std::function<Status(const std::filesystem::path& path)>;
/// Writes and reads a file. Checks the time, the memory (twice the file and `own_needs`, whatever the file claims) and
/// the form of the error. For programs that link counted_memory.cpp.
Status read_within_bounds(const TestFolder& folder, const Bytes& bytes, size_t own_needs, const ReadAll& read_all);

}  // namespace surfcast::model
