#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/result.h"
#include "ellipsoid/ellipsoids.h"
#include "model/block_encoder.h"
#include "model/ellipsoid_source.h"
#include "model/model_file.h"
#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"

namespace surfcast::ellipsoid {

/// Lattice indices within a block stay below 2^kPositionBits.
inline constexpr int kPositionBits = 20;

/// A decoded block. All ellipsoids of a block are of one source.
struct EllipsoidBlock {
  uint32_t source = 0;  ///< index into ModelFile::ellipsoid_sources()
  surfel::Grid grid;
  glm::i64vec3 origin{0};
  glm::u32vec3 extent{0};
  std::vector<glm::uvec3> positions;  ///< steps of the lattice from `origin`
  /// Eigenvalues, or semi-axes of a table: finite, descending, not below 0, the first one above 0. An ellipsoid of a
  /// tensor has no 0; one of a table may have, and is flat then.
  std::vector<glm::vec3> values;
  std::vector<glm::quat> rotations;  ///< unit; the columns of their matrices are the axes of the values in the world
  /// Merged ellipsoids of coarse blocks are drawn larger by this factor, so that they keep the area of those that they
  /// stand for; it is no part of their tensor. 1 in leaves.
  std::vector<float> factors;
  std::vector<glm::u8vec3> colors;  ///< sRGB; empty without colour
  /// The columns of EllipsoidSource::attributes behind the derived ones; of coarse blocks means, as floats.
  std::vector<surfel::ScalarAttribute> scalars;

  [[nodiscard]] size_t size() const { return positions.size(); }
  /// World coordinates of the stored position.
  [[nodiscard]] glm::dvec3 position(size_t i) const { return grid.position(origin + glm::i64vec3(positions[i])); }
};

/// Encodes ellipsoids of one source, given in a spatial order, as one block. The lattice passes through the origin; its
/// step is the largest power of two that moves none of 49 in 50 by more than 1/256 of its middle semi-axis at the
/// default scale, but not finer than the block's extent by 2^20. Values have a relative error of at most 1.1e-5,
/// axes one of at most 1e-5 radians. `number`: of the source. `merged`: of a coarse block, with factors, and scalars
/// that are floats. The spacing is that of the grid, or of neighbours along the path of the rows.
model::EncodedBlock encode_ellipsoids(const Ellipsoids& ellipsoids, const model::EllipsoidSource& source,
                                      uint32_t number, bool merged);

/// Checks and decodes a block. Fails on bytes that hold anything else than the tables of the model state.
Result<EllipsoidBlock> decode_ellipsoids(const model::StoredBlock& stored,
                                         std::span<const model::EllipsoidSource> sources);

}  // namespace surfcast::ellipsoid
