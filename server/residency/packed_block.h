#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "selection/block_hull.h"
#include "surfel/grid.h"

namespace surfcast::residency {

/// Where the position codes of a block lie.
struct PackedLattice {
  surfel::Grid grid;      ///< of the model
  glm::i64vec3 first{0};  ///< index of code 0 on it
  glm::ivec3 shift{0};    ///< a step of the codes is 2^shift steps of the grid
  glm::uvec3 largest{0};  ///< code

  /// World coordinates of a code; exact where `shift` is 0.
  [[nodiscard]] glm::dvec3 position(const glm::uvec3& code) const {
    return grid.position(first + (glm::i64vec3(code) << glm::i64vec3(shift)));
  }
  [[nodiscard]] glm::dvec3 step() const { return grid.scale * glm::dvec3(glm::ivec3(1) << shift); }
};

/// Intensities on a linear scale of 16 bits: first + step * code.
struct LinearScale {
  double first = 0;
  double step = 0;
};

/// Texels of a block that its kind's projection reads together.
struct TexelRun {
  uint32_t first = 0;  ///< counted from the first of the block
  uint32_t count = 0;  ///< at most SURFCAST_CHUNK
  uint32_t flags = 0;  ///< what the projection must know of them: bits above SURFCAST_RUN_COUNT
};

/// What the projection of a kind needs to know of a block beside its texels, and of which of these. One for each block,
/// immutable, made by the kind when it packs the block.
class BlockHeader {
 public:
  virtual ~BlockHeader() = default;
  /// BlockView::scale, for world units of 2^-unit.
  [[nodiscard]] virtual glm::vec4 scale(int unit) const = 0;
  /// Appends the texels of which a picture may show something where radii of that range are wanted.
  virtual void add_runs(const selection::RadiusRange& wanted, std::vector<TexelRun>& runs) const = 0;
};

/// A block never has more texels than so many for each of its items.
inline constexpr uint32_t kMaxPackedPerSurfel = 2;

/// A block in the form that the projection of its kind reads.
struct PackedBlock {
  PackedLattice lattice;             ///< holds everything that is drawn of the block but for radii
  std::vector<glm::uvec4> texels;    ///< at most kMaxPackedPerSurfel for each item
  std::vector<uint32_t> attributes;  ///< 16 bits of intensity, 8 of classification for each texel, if asked for
  LinearScale intensity;
  std::shared_ptr<const BlockHeader> header;

  [[nodiscard]] size_t bytes() const {
    return texels.size() * sizeof(glm::uvec4) + attributes.size() * sizeof(uint32_t);
  }
};

}  // namespace surfcast::residency
