#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/box.h"
#include "geometry/normal_cone.h"
#include "ldc/octree_key.h"
#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"
#include "surfel/surfel_cloud.h"

namespace surfcast {

/// What the header of a model says about all its blocks.
struct ModelInfo {
  uint64_t surfels = 0;
  Box bounds;                             ///< of the stored positions, world units
  bool oriented = false;                  ///< see SurfelCloud::oriented
  bool z_up = true;                       ///< see SurfelCloud::z_up
  int color_bits = 0;                     ///< 8 or 16; 0: the scan has no colour and no block stores any
  std::vector<std::string> scalar_names;  ///< attributes that every block stores, in order
  std::vector<std::string> source_names;  ///< the input files
};

/// One entry of the table of blocks: enough to select with, without touching the block.
struct BlockEntry {
  int level = 0;                      ///< 0 is the finest
  OctreeKey key;                      ///< the octree cell that holds it; parents and children follow from it
  Box bounds;                         ///< of the surfel centres, world units
  double spacing = 0;                 ///< median radius of its surfels, world units
  double max_radius = 0;              ///< largest radius of its surfels: what `bounds` must grow by to hold the discs
  std::optional<NormalCone> normals;  ///< holds all its normals; none when the model is not oriented
  uint32_t surfels = 0;
  uint64_t offset = 0;  ///< of its bytes in the file
  uint32_t bytes = 0;
  uint64_t checksum = 0;  ///< XXH3, 64 bit, of its bytes
};

/// A block as it comes out of Draco: structure of arrays of one length.
struct DecodedBlock {
  Grid grid;
  glm::i64vec3 origin{0};                ///< lattice index that `indices` count from
  std::vector<glm::ivec3> indices;       ///< non-negative lattice steps from `origin`
  std::vector<glm::vec3> normals;        ///< unit
  std::vector<float> radii;              ///< world units
  std::vector<float> weights;            ///< s_k
  std::vector<glm::u16vec3> colors;      ///< in ModelInfo::color_bits; empty without colour
  std::vector<ScalarAttribute> scalars;  ///< as ModelInfo::scalar_names

  [[nodiscard]] size_t size() const { return indices.size(); }
  /// World coordinates of surfel i, exact for inputs on a grid.
  [[nodiscard]] glm::dvec3 position(size_t i) const { return grid.position(origin + glm::i64vec3(indices[i])); }
};

/// An open model file. All methods are const and safe to call from several threads at once.
class ModelFile {
 public:
  static Result<ModelFile> open(const std::filesystem::path& path);

  ModelFile(ModelFile&&) noexcept;
  ModelFile& operator=(ModelFile&&) noexcept;
  ~ModelFile();

  [[nodiscard]] const ModelInfo& info() const;
  [[nodiscard]] std::span<const BlockEntry> blocks() const;
  /// Checks the checksum of a block and decodes it.
  [[nodiscard]] Result<DecodedBlock> decode(size_t block) const;
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Tells this opening of a file from every other one in the life of the process, also after it has been closed.
  [[nodiscard]] uint64_t id() const;

 private:
  struct State;
  explicit ModelFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast
