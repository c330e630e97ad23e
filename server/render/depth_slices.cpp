#include "render/depth_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace surfcast::render {
namespace {

// Bins of the logarithm of depth, from the farthest item towards the eye.
constexpr int kBinsPerOctave = 64;
constexpr int kBins = 24 * kBinsPerOctave;

/// Integer weight of an item in a bin: sums do not depend on the order of their terms.
constexpr uint64_t kItem = 4096;

/// One slice for each item per tile.
uint32_t count_for(size_t items, size_t tiles) {
  const size_t per_tile = items / std::max<size_t>(tiles, 1);
  return static_cast<uint32_t>(std::bit_floor(std::clamp<size_t>(per_tile, 1, SURFCAST_SLICES)));
}

int bin_of(double depth, double farthest) {
  if (depth <= 0) return kBins - 1;
  return std::clamp(static_cast<int>(std::log2(farthest / depth) * kBinsPerOctave), 0, kBins - 1);
}

/// Items by bin, nearest last.
std::vector<uint64_t> histogram(std::span<const DepthRange> ranges, double farthest) {
  std::vector<uint64_t> changes(kBins + 1);
  for (const DepthRange& range : ranges) {
    if (range.farthest <= 0) continue;
    const int first = bin_of(range.farthest, farthest);
    const int last = bin_of(range.nearest, farthest);
    const uint64_t share = range.items * kItem / static_cast<uint64_t>(last - first + 1);
    changes[static_cast<size_t>(first)] += share;
    changes[static_cast<size_t>(last) + 1] -= share;  // modulo 2^64
  }
  for (size_t i = 1; i < changes.size(); ++i) changes[i] += changes[i - 1];
  changes.pop_back();
  return changes;
}

}  // namespace

DepthSlices depth_slices(std::span<const DepthRange> ranges, size_t tiles) {
  uint64_t items = 0;
  double farthest = 0;
  for (const DepthRange& range : ranges) {
    items += range.items;
    farthest = std::max(farthest, range.farthest);
  }
  DepthSlices slices;
  slices.near[0] = std::numeric_limits<float>::infinity();
  if (farthest <= 0) return slices;
  slices.count = count_for(items, tiles);
  const std::vector<uint64_t> bins = histogram(ranges, farthest);
  uint64_t total = 0;
  for (const uint64_t bin : bins) total += bin;
  uint64_t passed = 0;
  uint32_t slice = 1;
  for (size_t bin = bins.size(); bin-- > 0;) {
    passed += bins[bin];
    const double begin = farthest * std::exp2(-static_cast<double>(bin) / kBinsPerOctave);
    for (; slice < slices.count && passed >= total / slices.count * slice; ++slice) {
      slices.near.at(slice) = static_cast<float>(1 / begin);
    }
  }
  return slices;
}

}  // namespace surfcast::render
