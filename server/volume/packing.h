#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "volume/brick.h"

namespace surfcast::volume {

/// Brick texels for the GPU: the codes, two in a word, the first in its low half, in the order of Brick::codes without
/// gaps. Then, from the next texel on, the code ranges of sub-bricks of 8 x 8 x 8 samples, always 4 x 4 x 4 of them, i
/// fastest: one word each, the least code in the low half, the largest in the high half. A range is taken over the
/// samples from two before the sub-brick to two after it. A sub-brick beyond the last sample has the range 0xffff to 0.
inline constexpr uint32_t kSubBricks = 4;
inline constexpr uint32_t kSubBrickSamples = kBrickSamples / kSubBricks;

/// Texels of the codes; the ranges follow.
[[nodiscard]] uint32_t code_texels(const glm::u32vec3& count);
[[nodiscard]] uint32_t packed_texels(const glm::u32vec3& count);
/// Items of the block of a brick: its samples without the halo, but at least half its texels (docs/kinds.md).
[[nodiscard]] uint32_t brick_items(const glm::u32vec3& count);

[[nodiscard]] std::vector<glm::uvec4> pack_brick(const Brick& brick);

}  // namespace surfcast::volume
