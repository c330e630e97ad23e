#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "model/block_encoder.h"
#include "model/field.h"
#include "surfel/grid.h"

namespace surfcast::model {

// The positions of blocks whose items are Gaussians or ellipsoids: indices of a lattice that fits the items' sizes.

/// Indices from the lowest one stay below 2^kItemIndexBits in a block.
inline constexpr int kItemIndexBits = 20;

/// The error that a lattice may give to positions: what lets one item in 50 be finer than `share` of the item allows.
/// `sizes`: of the items, world units.
[[nodiscard]] double item_tolerance(std::vector<double> sizes, double share);

/// The coarsest lattice through the origin that moves no position by more than `tolerance`, but not finer than the
/// extent of the positions by 2^kItemIndexBits.
[[nodiscard]] surfel::Grid item_lattice(std::span<const glm::dvec3> positions, double tolerance);

/// Positions as indices from the lowest one. Sets the origin and the extent of the block, whose grid is set.
[[nodiscard]] std::vector<glm::ivec3> item_indices(std::span<const glm::dvec3> positions, EncodedBlock& block);

/// The median distance along a path through the indices, world units; at least `lattice`, a step of the lattice.
[[nodiscard]] double step_along(std::span<const glm::ivec3> indices, std::span<const uint32_t> path, double lattice);

/// Three columns: the components of the vectors along the path.
[[nodiscard]] Field vector_field(std::span<const uint32_t> path, const auto& values) {
  Field field(3);
  for (int axis = 0; axis < 3; ++axis) {
    Column& column = field[static_cast<size_t>(axis)];
    column.reserve(path.size());
    for (const uint32_t i : path) column.push_back(static_cast<uint64_t>(values[i][axis]));
  }
  return field;
}

/// True if no value of a column is above the limit: encoders write none.
[[nodiscard]] bool all_at_most(const Column& column, uint64_t limit);
/// The same of all columns of a field.
[[nodiscard]] bool all_at_most(const Field& field, uint64_t limit);

/// True if the positions of a block are within its extent.
[[nodiscard]] bool within_extent(const Field& positions, const glm::u32vec3& extent);

}  // namespace surfcast::model
