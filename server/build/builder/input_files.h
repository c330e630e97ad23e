#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::builder {

/// What a file is made into.
enum class InputKind { kScan, kGrid, kGaussians, kEllipsoids, kMesh };

/// The kind of an input, by its content. What cannot be read counts as a scan: reading it reports the error.
[[nodiscard]] InputKind kind_of_input(const std::filesystem::path& path);

/// The files in a folder that may be inputs, by their extensions, in the order of their names.
[[nodiscard]] std::vector<std::filesystem::path> inputs_in(const std::filesystem::path& folder);

/// The inputs that a path names: of a folder that is no input by itself, those in it. Fails if it has none.
Result<std::vector<std::filesystem::path>> inputs_at(const std::filesystem::path& path);

/// What can be told of an input without reading its items: whether it is of a known format, and whether its header
/// makes sense. Of a grid all files must be there that its header names.
Status check_input(const std::filesystem::path& path);

/// All files that an input is read from: its own first, then those that it names (data files of grids, pictures of
/// SOG, materials and textures of meshes, everything in the folder of EPT, Potree and tilesets). Of a folder its
/// description is the first.
Result<std::vector<std::filesystem::path>> files_of_input(const std::filesystem::path& path);

/// Bytes of all files of an input; 0 if they cannot be found.
[[nodiscard]] uint64_t bytes_of_input(const std::filesystem::path& path);

/// The extensions of the files that may be inputs, lower case with their dot.
std::vector<std::string> input_extensions();
/// The extensions of the files that only inputs name: the samples behind a header.
std::vector<std::string> data_extensions();

}  // namespace surfcast::builder
