#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "builder/build_model.h"
#include "model/model_file.h"
#include "model/test_folder.h"
#include "volume/brick.h"

namespace surfcast::builder {

namespace fs = std::filesystem;

/// A grid of numbers and how it is written.
struct Grid {
  glm::u32vec3 size{1};
  std::string type = "uint16";
  std::string lines = "spacings: 1 1 1\n";  ///< more of the header
  std::vector<double> samples;

  [[nodiscard]] double at(uint32_t i, uint32_t j, uint32_t k) const {
    return samples[(size_t{k} * size.y + j) * size.x + i];
  }
};

template <typename Sample>
Grid make_grid(const glm::u32vec3& size, const Sample& sample) {
  Grid grid;
  grid.size = size;
  for (uint32_t k = 0; k < size.z; ++k) {
    for (uint32_t j = 0; j < size.y; ++j) {
      for (uint32_t i = 0; i < size.x; ++i) grid.samples.push_back(static_cast<double>(sample(i, j, k)));
    }
  }
  return grid;
}

/// Noise of 12 bits on a ramp along i.
Grid noise_grid(const glm::u32vec3& size);
/// The level above, by its definition and in double precision.
Grid halved(const Grid& grid);

/// The samples as bytes of the grid's type.
std::string bytes_of(const Grid& grid, bool big);
/// The header of an NRRD file; `more`: further lines.
std::string nrrd_header(const Grid& grid, const std::string& more);
fs::path write_text(const fs::path& path, const std::string& text);
fs::path write_grid(const fs::path& path, const Grid& grid, bool big = false);

Result<BuildReport> build(const fs::path& grid, const fs::path& target, const BuildOptions& options = {});
/// Builds a grid and opens the model.
model::ModelFile build_and_open(const model::TestFolder& folder, const Grid& grid, bool big = false);
/// The message of a build that fails, and leaves no model; empty if it does not fail.
std::string fault_of(const fs::path& grid, const fs::path& target, const BuildOptions& options = {});

/// A level as the bricks of a model give it. Samples in halos are compared with it.
class LevelSamples {
 public:
  LevelSamples(const model::ModelFile& model, uint32_t level);

  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  /// The largest difference of a sample of any brick, halos included, to the same sample of `level`.
  [[nodiscard]] double largest_difference(const std::vector<double>& level) const;

 private:
  [[nodiscard]] size_t index_of(const glm::i64vec3& at) const;
  void keep(const volume::Brick& brick);

  glm::u32vec3 size_;
  std::vector<double> values_;
  std::vector<volume::Brick> bricks_;
};

}  // namespace surfcast::builder
