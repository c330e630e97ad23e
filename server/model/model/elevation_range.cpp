#include "model/elevation_range.h"

#include <algorithm>

namespace surfcast::model {
namespace {

constexpr double kElevationTail = 0.005;
constexpr double kBeyond = 0.1;
constexpr double kMaxLeftOut = 0.1;

/// The number of the slab's items below an elevation.
double items_below(const ElevationSlab& slab, double elevation) {
  const auto [low, high] = slab.range;
  const double share = high > low ? (elevation - low) / (high - low) : (elevation >= low ? 1 : 0);
  return std::clamp(share, 0.0, 1.0) * slab.items;
}

/// The elevation below which this many items lie, by bisection.
double elevation_above(std::span<const ElevationSlab> slabs, double items, ElevationRange range) {
  constexpr int kSteps = 24;
  for (int step = 0; step < kSteps; ++step) {
    const double middle = (range.low + range.high) / 2;
    double below = 0;
    for (const ElevationSlab& slab : slabs) below += items_below(slab, middle);
    (below < items ? range.low : range.high) = middle;
  }
  return (range.low + range.high) / 2;
}

}  // namespace

ElevationRange elevation_range(std::span<const ElevationSlab> slabs) {
  if (slabs.empty()) return {};
  ElevationRange all = slabs.front().range;
  double items = 0;
  for (const ElevationSlab& slab : slabs) {
    all = {std::min(all.low, slab.range.low), std::max(all.high, slab.range.high)};
    items += slab.items;
  }
  const double low = elevation_above(slabs, kElevationTail * items, all);
  const double high = elevation_above(slabs, (1 - kElevationTail) * items, all);
  const double beyond = kBeyond * (high - low);
  const ElevationRange most{std::max(low - beyond, all.low), std::min(high + beyond, all.high)};
  const bool few_left_out = most.high - most.low >= (1 - kMaxLeftOut) * (all.high - all.low);
  return few_left_out || most.low >= most.high ? all : most;
}

}  // namespace surfcast::model
