#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "mesh/mesh_reader.h"
#include "mesh/sample_mesh.h"

namespace surfcast::mesh {

/// A folder of its own for the files of a test; removed with them.
class MeshFolder {
 public:
  MeshFolder();
  ~MeshFolder();
  MeshFolder(const MeshFolder&) = delete;
  MeshFolder& operator=(const MeshFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& content) const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

using Texel = std::array<uint8_t, 4>;

/// A Targa file with alpha, rows from the upper edge.
std::string targa(int width, int height, const std::function<Texel(int x, int y)>& texel);

/// A square of side `side` in the plane z = 0, texture coordinates (0, 0) at its lower left corner, material `m` of
/// square.mtl, which names the image.
void write_square(const MeshFolder& folder, const std::string& image, double side);

Result<Mesh> read(const std::filesystem::path& path);

struct Sampled {
  std::vector<MeshSurfel> surfels;
  MeshReport report;
};

/// Stops the test program if the mesh cannot be sampled.
Sampled sample(const Mesh& mesh, const SampleOptions& options = {});
Sampled sample(const std::filesystem::path& path, const SampleOptions& options = {});

}  // namespace surfcast::mesh
