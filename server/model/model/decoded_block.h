#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"

namespace surfcast::model {

/// A decoded block of surfels: a structure of arrays of equal length.
struct DecodedBlock {
  surfel::Grid grid;
  bool oriented = false;             ///< see SurfelCloud::oriented
  glm::i64vec3 origin{0};            ///< lattice index of the origin of `indices`
  std::vector<glm::ivec3> indices;   ///< non-negative lattice steps from `origin`
  std::vector<glm::vec3> normals;    ///< unit
  std::vector<float> radii;          ///< world units
  std::vector<float> weights;        ///< s_k
  std::vector<uint8_t> scatter;      ///< 1: on no surface (SurfelCloud::scatter); empty if none of the block is
  std::vector<glm::u16vec3> colors;  ///< in ModelInfo::color_bits; empty without colour
  /// In a leaf, the attributes of ModelInfo::scalar_names. In a coarse block, only those of ldc::is_coarse_scalar.
  /// Only the first ones if not all were requested.
  std::vector<surfel::ScalarAttribute> scalars;

  [[nodiscard]] size_t size() const { return indices.size(); }
  [[nodiscard]] bool is_scatter(size_t i) const { return !scatter.empty() && scatter[i] != 0; }
  /// World coordinates of surfel i, exact for inputs whose coordinates lie on a grid.
  [[nodiscard]] glm::dvec3 position(size_t i) const { return grid.position(origin + glm::i64vec3(indices[i])); }
};

/// A block as stored in the file.
struct StoredBlock {
  std::span<const std::byte> bytes;  ///< valid until this thread reads another block
  surfel::Grid grid;
  glm::i64vec3 origin{0};  ///< lattice index of the lowest corner of its bounds
  glm::u32vec3 extent{0};  ///< lattice index of the highest corner, relative to `origin`
  uint32_t items = 0;      ///< surfels, or items of another kind
  uint32_t scatter = 0;    ///< how many of them lie on no surface
};

/// The scalar attributes to decode with a block. Decoding all of them takes about as long as decoding everything that
/// is drawn.
enum class WantedScalars {
  kNone,
  kDrawn,  ///< at least the attributes that determine colour or visibility, which coarse blocks have too
  kAll,
};

}  // namespace surfcast::model
