#pragma once

#include <cstddef>
#include <optional>

#include "geometry/box.h"
#include "surfel/grid.h"

namespace surfcast::ldc {

/// Lattice indices within a block stay below 2^kMaxIndexBits, which leaves headroom in a signed 32 bit integer.
inline constexpr int kMaxIndexBits = 30;
/// In blocks with at least kDenseBlockSurfels surfels, indices stay below 2^kIndexBits. A dense cluster that is much
/// smaller than its block then gets a block of its own, where the step of a compact vertex is small compared with the
/// distance between surfels. Fewer surfels do not justify a block of their own.
inline constexpr int kIndexBits = 20;
inline constexpr size_t kDenseBlockSurfels = 256;
/// Without a requested precision, the error of a stored position is at most the radius of its surfel divided by this.
inline constexpr double kRadiusOverError = 256;

/// The coarsest lattice of step 2^k through the origin on which every point of the box has a lattice point within
/// `max_error` (Euclidean, world units). The step is never finer than the spacing of doubles at the box, because such a
/// lattice contains every coordinate exactly.
surfel::Grid choose_lattice(const geometry::Box& box, double max_error);

/// Largest Euclidean error accepted for a surfel of this radius, world units.
inline double position_tolerance(double radius, const std::optional<double>& precision) {
  return precision ? *precision : radius / kRadiusOverError;
}

/// True if the indices of `count` points in the box, counted from its lowest corner, stay within the limits of a block.
bool indices_fit(const surfel::Grid& grid, const geometry::Box& box, size_t count);

}  // namespace surfcast::ldc
