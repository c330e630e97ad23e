#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "volume/brick.h"

namespace surfcast::volume {

/// Brick texels for the GPU. A texel holds 8 successive codes of a row, two in a word, the first in its low half. The
/// next texel of the row begins SURFCAST_WINDOW_STRIDE codes later, so that any four successive codes are in one texel.
/// Rows follow each other in a slice; slices, in the order of k, never straddle a page of GPU memory.
struct BrickLayout {
  uint32_t row = 0;              ///< texels of a row
  uint32_t slice = 0;            ///< texels of a slice
  uint32_t slices_per_page = 0;  ///< whole slices in a page of SURFCAST_PAGE_TEXELS
};
[[nodiscard]] BrickLayout brick_layout(const glm::u32vec3& count);

/// Texels of a brick; unused ones at the ends of pages count, except those of the last page.
[[nodiscard]] uint32_t packed_texels(const glm::u32vec3& count);
/// Items of the block of a brick: its samples without the halo, but at least half its texels (docs/kinds.md).
[[nodiscard]] uint32_t brick_items(const glm::u32vec3& count);

/// The most texels of a brick whose block has so many items; 0 if no brick has as many.
[[nodiscard]] uint32_t most_texels(uint32_t items);

[[nodiscard]] std::vector<glm::uvec4> pack_brick(const Brick& brick);

/// Sub-bricks of 2 x 2 x 2 samples: 16 along each axis, whatever the size of the brick.
inline constexpr uint32_t kSubBricks = 16;
inline constexpr uint32_t kSubBrickSamples = kBrickSamples / kSubBricks;
inline constexpr size_t kAllSubBricks = size_t{kSubBricks} * kSubBricks * kSubBricks;

/// The least and the largest code; the largest is below the least where there is none.
struct CodeRange {
  uint16_t low = 0xffff;
  uint16_t high = 0;
  bool operator==(const CodeRange&) const = default;
};

/// The codes that reconstruction in each sub-brick may find, kAllSubBricks, i fastest. It may find more than the
/// samples, and less than 0 and more than 65535: these two stand for all beyond them. Empty for a sub-brick beyond the
/// last sample. (The range of the control points of the Bezier form of the reconstruction in each cell, which is
/// narrow.)
[[nodiscard]] std::vector<CodeRange> sub_brick_ranges(const Brick& brick);

/// Cubic reconstruction overshoots the samples that it reads by at most this part of their range: weights of either
/// sign sum to 1.25 along an axis.
inline constexpr double kOvershoot = 0.5 * (1.25 * 1.25 * 1.25 - 1);

}  // namespace surfcast::volume
