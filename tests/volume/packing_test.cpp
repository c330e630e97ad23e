#include "volume/packing.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::volume {
namespace {

Brick numbered_brick(const glm::u32vec3& count) {
  Brick brick;
  brick.header.count = count;
  brick.codes.resize(stored_samples(count));
  std::iota(brick.codes.begin(), brick.codes.end(), uint16_t{0});
  return brick;
}

uint32_t word(const std::vector<glm::uvec4>& texels, size_t i) {
  return texels[i / 4][static_cast<int>(i % 4)];
}

TEST(BrickPacking, codes_are_halves_of_words_in_order) {
  const Brick brick = numbered_brick({32, 32, 32});
  const std::vector<glm::uvec4> texels = pack_brick(brick);
  ASSERT_EQ(texels.size(), packed_texels({32, 32, 32}));
  for (size_t i = 0; i < brick.codes.size(); ++i) {
    ASSERT_EQ(word(texels, i / 2) >> (i % 2 * 16) & 0xffffU, brick.codes[i]);
  }
}

TEST(BrickPacking, ranges_of_sub_bricks_cover_two_samples_on_each_side) {
  Brick brick = numbered_brick({32, 32, 32});
  std::ranges::fill(brick.codes, uint16_t{100});
  // Sample (8, 0, 0) with its halo before it: stored index (10, 2, 2).
  brick.codes[(size_t{2} * 36 + 2) * 36 + 10] = 7;
  const std::vector<glm::uvec4> texels = pack_brick(brick);
  const size_t first = size_t{code_texels({32, 32, 32})} * 4;
  EXPECT_EQ(word(texels, first + 0), 7U | 100U << 16);
  EXPECT_EQ(word(texels, first + 1), 7U | 100U << 16);
  EXPECT_EQ(word(texels, first + 2), 100U | 100U << 16);
  EXPECT_EQ(word(texels, first + 4), 100U | 100U << 16);
}

TEST(BrickPacking, sub_bricks_beyond_the_samples_are_empty) {
  const Brick brick = numbered_brick({9, 1, 1});
  const std::vector<glm::uvec4> texels = pack_brick(brick);
  const size_t first = size_t{code_texels({9, 1, 1})} * 4;
  EXPECT_EQ(word(texels, first), 0U | (11U + 13U * 24U) << 16);
  EXPECT_EQ(word(texels, first + 1), 8U | (13U * 25U - 1U) << 16);
  EXPECT_EQ(word(texels, first + 2), 0x0000ffffU);
  EXPECT_EQ(word(texels, first + 16), 0x0000ffffU);
}

TEST(BrickPacking, a_block_has_at_most_two_texels_per_item) {
  for (uint32_t n = 1; n <= kBrickSamples; ++n) {
    for (const glm::u32vec3 count : {glm::u32vec3(n, 1, 1), glm::u32vec3(1, n, n), glm::u32vec3(n)}) {
      EXPECT_LE(packed_texels(count), 2 * brick_items(count));
      EXPECT_LE(brick_items(count), 32768U);
      EXPECT_GE(brick_items(count), count.x * count.y * count.z);
    }
  }
}

}  // namespace
}  // namespace surfcast::volume
