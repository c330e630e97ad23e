#pragma once

#include <cstddef>
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
  int32_t count = 1;   ///< at most SURFCAST_SLICES
  int32_t second = 0;  ///< bits of the inverse depth at which the second slice begins
  int32_t step = 1;    ///< from there to the next slice, towards 0
};

/// Slices from where the nearest of the items lie to where the farthest lie, few of them left out on either side. There
/// is more than one where it pays off: with few items for each of `tiles` tiles, lists are short, and sums over slices
/// would take longer than what hidden items cost. Items count as spread evenly, over the logarithm of depth, within
/// their range. `culled`: half of the items face away and are not drawn. The result does not depend on the order of
/// ranges.
DepthSlices depth_slices(std::span<const DepthRange> ranges, bool culled, size_t tiles);

}  // namespace surfcast::render
