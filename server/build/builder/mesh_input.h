#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "mesh/mesh_format.h"
#include "mesh/sample_mesh.h"
#include "scan/scan_stream.h"

namespace surfcast::builder {

/// How meshes become surfels.
struct MeshOptions {
  std::optional<double> spacing{};  ///< see mesh::SampleOptions
  uint64_t most_surfels = mesh::kMaxSurfels;
  mesh::FacePolicy faces = mesh::FacePolicy::kAuto;
};

/// What became of a mesh.
struct InputMesh {
  std::string input;  ///< file name without its folders
  mesh::MeshReport report;
};

/// True if the file is a mesh whose faces become surfels. False also if it cannot be read.
[[nodiscard]] bool is_mesh(const std::filesystem::path& path, mesh::FacePolicy faces = mesh::FacePolicy::kAuto);

/// Makes surfels of the mesh, which wait in a temporary file beside `target`, and presents them as a scan. `limit`:
/// memory for the mesh and for one texture; the stream needs none. `sample`: surfels of a preview. What was found is
/// added to `found`.
Result<scan::ScanStream> open_mesh(const std::filesystem::path& path, const MeshOptions& options,
                                   const scan::DecodingLimit& limit, std::optional<uint64_t> sample,
                                   const std::filesystem::path& target, std::vector<InputMesh>& found);

}  // namespace surfcast::builder
