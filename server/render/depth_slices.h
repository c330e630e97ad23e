#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shared/frame_layout.h"

namespace surfcast::render {

/// Items between two depths along the view axis.
struct DepthRange {
  double nearest = 0;  ///< any unit of length; 0 or less: behind the eye
  double farthest = 0;
  uint64_t items = 0;
};

/// The slices of depth by which the lists of tiles are sorted (shaders/include/depth_slices.glsl).
struct DepthSlices {
  uint32_t count = 1;                         ///< a power of two of at most SURFCAST_SLICES
  std::array<float, SURFCAST_SLICES> near{};  ///< inverse depth at which each slice begins, descending
};

/// Slices with similar numbers of items, as many as pay off: with few items for each of `tiles` tiles, lists are short,
/// and sums over slices would take longer than what hidden items cost. Items count as spread evenly, over the logarithm
/// of depth, within their range. The result does not depend on the order of ranges.
DepthSlices depth_slices(std::span<const DepthRange> ranges, size_t tiles);

}  // namespace surfcast::render
