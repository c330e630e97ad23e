#include "render/depth_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

namespace surfcast::render {
namespace {

// Bins of the logarithm of depth, from the farthest item towards the eye.
constexpr int kBinsPerOctave = 64;
constexpr int kBins = 24 * kBinsPerOctave;

/// Integer weight of an item in a bin: sums do not depend on the order of their terms.
constexpr uint64_t kItem = 4096;

constexpr uint64_t kMinItems = 8;  // per tile; a picture of one surface at the finest spacing has about as many

int32_t count_for(uint64_t items, size_t tiles) {
  const uint64_t per_tile = items / std::max<size_t>(tiles, 1);
  if (per_tile < kMinItems) return 1;
  return static_cast<int32_t>(std::min<uint64_t>(2 * per_tile, SURFCAST_SLICES));
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

DepthSlices depth_slices(std::span<const DepthRange> ranges, bool culled, size_t tiles) {
  constexpr uint64_t kLeftOut = 64;  // of so many items, one on either side
  uint64_t items = 0;
  double farthest = 0;
  for (const DepthRange& range : ranges) {
    items += range.items;
    farthest = std::max(farthest, range.farthest);
  }
  DepthSlices slices;
  if (farthest <= 0) return slices;
  slices.count = count_for(culled ? items / 2 : items, tiles);
  const std::vector<uint64_t> bins = histogram(ranges, farthest);
  const uint64_t total = std::accumulate(bins.begin(), bins.end(), uint64_t{0});
  // The depth that `part` items lie behind.
  const auto bits_at = [&](uint64_t part) {
    uint64_t passed = 0;
    size_t bin = 0;
    while (bin + 1 < bins.size() && passed + bins[bin] <= part) passed += bins[bin++];
    return std::bit_cast<int32_t>(static_cast<float>(std::exp2(static_cast<double>(bin) / kBinsPerOctave) / farthest));
  };
  slices.second = bits_at(total - total / kLeftOut);
  slices.step = std::max((slices.second - bits_at(total / kLeftOut)) / (SURFCAST_SLICES - 1), 1);
  return slices;
}

}  // namespace surfcast::render
