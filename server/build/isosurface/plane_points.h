#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "isosurface/surface_point.h"

namespace surfcast::isosurface {

/// A sample beside the surface, moved onto it.
struct MovedSample {
  int64_t i = 0;
  bool inside = false;  ///< the sample, before it was moved
  SurfacePoint point;
};

/// The moved samples of a row, by ascending i.
struct RowPoints {
  std::vector<MovedSample> points;
  uint64_t lost = 0;  ///< samples beside the surface that could not be moved
};

/// The rows of a plane.
using PlanePoints = std::vector<RowPoints>;

/// Moves the samples of a row that have a neighbour on the other side of the surface. The window holds the planes from
/// `k` - kPlanesBefore to `k` + kPlanesBehind that the grid has.
[[nodiscard]] RowPoints points_of_row(const SampleWindow& samples, int64_t j, int64_t k, double value);

/// The planes on either side in which the samples of neighbouring points lie.
inline constexpr int64_t kThinningReach = 2;

/// Whether a point of row `j` is needed for an even sampling. Those of samples inside are: on a plane they are 0.7
/// steps or more apart. One of a sample outside is where none of them is within half a step. `around`: the planes from
/// kThinningReach before that of the point to kThinningReach behind it that the grid has.
[[nodiscard]] bool is_needed(const MovedSample& moved, int64_t j, std::span<const PlanePoints> around);

}  // namespace surfcast::isosurface
