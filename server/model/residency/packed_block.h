#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "selection/block_hull.h"
#include "surfel/grid.h"

namespace surfcast::residency {

/// The lattice of the position codes of a block.
struct PackedLattice {
  surfel::Grid grid;      ///< of the model
  glm::i64vec3 first{0};  ///< index of code 0 on the grid
  glm::ivec3 shift{0};    ///< a step of the codes is 2^shift steps of the grid
  glm::uvec3 largest{0};  ///< largest code along each axis

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

/// A run of texels of a block that the projection of its kind reads together.
struct TexelRun {
  uint32_t first = 0;  ///< relative to the first texel of the block
  uint32_t count = 0;  ///< at most SURFCAST_CHUNK
  uint32_t flags = 0;  ///< parameters for the projection, in the bits above SURFCAST_RUN_COUNT
};

struct PackedBlock;

/// Parameters of a block for the projection of its kind: the scale of its texels, and the runs of texels to project.
/// There is one header per block. It is immutable and made by the kind when it packs the block.
class BlockHeader {
 public:
  virtual ~BlockHeader() = default;
  /// BlockView::scale for lengths in units of 2^-unit world units.
  [[nodiscard]] virtual glm::vec4 scale(int unit) const = 0;
  /// Appends the runs of texels that may be visible in a picture that requests radii in this range.
  virtual void add_runs(const selection::RadiusRange& wanted, std::vector<TexelRun>& runs) const = 0;
  /// The number of items whose centres the kind tells; none by default. `block`: that of the header.
  [[nodiscard]] virtual size_t centres(const PackedBlock& /*block*/) const { return 0; }
  /// One of these centres, world units.
  [[nodiscard]] virtual glm::dvec3 centre(const PackedBlock& /*block*/, size_t /*i*/) const { return glm::dvec3(0); }
};

/// The largest number of texels of a block per item.
inline constexpr uint32_t kMaxPackedPerSurfel = 2;

/// A block in the format that the projection of its kind reads.
struct PackedBlock {
  PackedLattice lattice;           ///< contains the centres of all items
  std::vector<glm::uvec4> texels;  ///< at most kMaxPackedPerSurfel per item
  std::vector<uint32_t>
      attributes;  ///< for each texel intensity (16 bits), classification and opacity (8); empty if not requested
  LinearScale intensity;
  std::shared_ptr<const BlockHeader> header;

  [[nodiscard]] size_t bytes() const {
    return texels.size() * sizeof(glm::uvec4) + attributes.size() * sizeof(uint32_t);
  }
};

}  // namespace surfcast::residency
