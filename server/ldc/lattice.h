#pragma once

#include <cstddef>
#include <optional>

#include "geometry/box.h"
#include "surfel/grid.h"

namespace surfcast::ldc {

/// Lattice indices within a block stay below 2^kMaxIndexBits, so that they fit a signed 32 bit integer with room.
inline constexpr int kMaxIndexBits = 30;
/// Those of a block with kDenseBlockSurfels surfels or more stay below 2^kIndexBits: a dense cluster far smaller than
/// its block gets a block of its own, where a step of a compact vertex is small next to the distance of its surfels.
/// Fewer surfels are not worth that.
inline constexpr int kIndexBits = 20;
inline constexpr size_t kDenseBlockSurfels = 256;
/// Without a wanted precision a stored position is off by at most its surfel's radius over this.
inline constexpr double kRadiusOverError = 256;

/// The coarsest lattice of step 2^k through the origin on which every point of the box has a lattice point within
/// `max_error` (Euclidean, world units). The step is never finer than the spacing of doubles at the box: there, the
/// lattice already holds every coordinate exactly.
surfel::Grid choose_lattice(const geometry::Box& box, double max_error);

/// Largest Euclidean error to accept for a surfel of that radius.
inline double position_tolerance(double radius, const std::optional<double>& precision) {
  return precision ? *precision : radius / kRadiusOverError;
}

/// True when so many points in the box get indices that a block may have, counted from the box's lowest corner.
bool indices_fit(const surfel::Grid& grid, const geometry::Box& box, size_t count);

}  // namespace surfcast::ldc
