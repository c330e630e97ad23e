#include "model/elevation_range.h"

#include <algorithm>

namespace surfcast::model {
namespace {

constexpr double kTail = 0.002;
constexpr double kMostLeftOut = 0.1;

/// The number of the block's items below an elevation.
double items_below(const ldc::BlockEntry& block, int axis, double elevation) {
  const double low = block.bounds.min[axis];
  const double height = block.bounds.max[axis] - low;
  const double share = height > 0 ? (elevation - low) / height : (elevation >= low ? 1 : 0);
  return std::clamp(share, 0.0, 1.0) * block.surfels;
}

/// The elevation below which this many items lie, by bisection.
double elevation_above(std::span<const ldc::BlockEntry> leaves, int axis, double items, ElevationRange range) {
  constexpr int kSteps = 24;
  for (int step = 0; step < kSteps; ++step) {
    const double middle = (range.low + range.high) / 2;
    double below = 0;
    for (const ldc::BlockEntry& block : leaves) below += items_below(block, axis, middle);
    (below < items ? range.low : range.high) = middle;
  }
  return (range.low + range.high) / 2;
}

}  // namespace

ElevationRange elevation_range(std::span<const ldc::BlockEntry> leaves, int up_axis) {
  geometry::Box bounds;
  double items = 0;
  for (const ldc::BlockEntry& block : leaves) {
    bounds.include(block.bounds);
    items += block.surfels;
  }
  if (leaves.empty()) return {};
  const ElevationRange all{bounds.min[up_axis], bounds.max[up_axis]};
  const ElevationRange most{elevation_above(leaves, up_axis, kTail * items, all),
                            elevation_above(leaves, up_axis, (1 - kTail) * items, all)};
  const bool few_left_out = most.high - most.low >= (1 - kMostLeftOut) * (all.high - all.low);
  return few_left_out || most.low >= most.high ? all : most;
}

}  // namespace surfcast::model
