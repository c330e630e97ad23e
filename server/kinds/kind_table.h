#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "kinds/kind.h"
#include "model/model_file.h"

namespace surfcast::kinds {

/// The kinds that a program knows. A kind's number is its place in the table.
using KindTable = std::span<const Kind* const>;

/// Those that every program knows.
KindTable built_in_kinds();

/// For each of ModelInfo::kinds its number. Fails on a kind that is not in the table, and names it.
Result<std::vector<uint32_t>> find_kinds(const model::ModelFile& model, KindTable table);

}  // namespace surfcast::kinds
