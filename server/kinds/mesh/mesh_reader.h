#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "mesh/mesh.h"
#include "mesh/mesh_format.h"
#include "scan/row_source.h"

namespace surfcast::mesh {

/// The format of the file; none if it cannot be read or is no mesh.
[[nodiscard]] std::optional<MeshFormat> mesh_format_of(const std::filesystem::path& path,
                                                       FacePolicy faces = FacePolicy::kAuto);

/// Reads a mesh of that format. Images are found and not read. Fails with the file's name where anything is wrong that
/// leaves no triangle, and where reading takes more memory than `limit`, which a file states by its size.
Result<Mesh> read_mesh(const std::filesystem::path& path, MeshFormat format, const scan::DecodingLimit& limit);

/// The file of a mesh, and all files that it names and that are there.
Result<std::vector<std::filesystem::path>> files_of_mesh(const std::filesystem::path& path, MeshFormat format);

}  // namespace surfcast::mesh
