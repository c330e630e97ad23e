#include "volume/packing.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "shared/volume_layout.h"

namespace surfcast::volume {
namespace {

Brick numbered_brick(const glm::u32vec3& count) {
  Brick brick;
  brick.header.count = count;
  brick.codes.resize(stored_samples(count));
  std::iota(brick.codes.begin(), brick.codes.end(), uint16_t{0});
  return brick;
}

uint32_t code_in(const glm::uvec4& texel, uint32_t i) {
  return texel[static_cast<int>(i / 2)] >> (i % 2 * 16) & 0xffffU;
}

void expect_four_codes_in_one_texel(const Brick& brick) {
  const glm::u32vec3 size = stored_size(brick.header.count);
  const BrickLayout layout = brick_layout(brick.header.count);
  const std::vector<glm::uvec4> texels = pack_brick(brick);
  ASSERT_EQ(texels.size(), packed_texels(brick.header.count));
  for (uint32_t z = 0; z < size.z; ++z) {
    const size_t slice =
        size_t{z / layout.slices_per_page} * SURFCAST_PAGE_TEXELS + size_t{z % layout.slices_per_page} * layout.slice;
    EXPECT_LE(slice % SURFCAST_PAGE_TEXELS + layout.slice, size_t{SURFCAST_PAGE_TEXELS});
    for (uint32_t y = 0; y < size.y; ++y) {
      for (uint32_t x = 0; x + 4 <= size.x; ++x) {
        const glm::uvec4 texel = texels.at(slice + size_t{y} * layout.row + x / SURFCAST_WINDOW_STRIDE);
        for (uint32_t i = 0; i < 4; ++i) {
          ASSERT_EQ(code_in(texel, x % SURFCAST_WINDOW_STRIDE + i),
                    brick.codes[(size_t{z} * size.y + y) * size.x + x + i]);
        }
      }
    }
  }
}

TEST(BrickPacking, AnyFourSuccessiveCodesAreInOneTexelAndSlicesInOnePage) {
  for (const glm::u32vec3 count :
       {glm::u32vec3(32), glm::u32vec3(1), glm::u32vec3(17, 5, 32), glm::u32vec3(1, 32, 9)}) {
    expect_four_codes_in_one_texel(numbered_brick(count));
  }
}

TEST(BrickPacking, RangesOfSubBricksHoldTheSamplesThatReconstructionReads) {
  Brick brick = numbered_brick(glm::u32vec3(32));
  std::ranges::fill(brick.codes, uint16_t{100});
  // Sample (5, 0, 0): stored index (7, 2, 2).
  brick.codes[(size_t{2} * 36 + 2) * 36 + 7] = 7;
  const auto ranges = sub_brick_ranges(brick);
  EXPECT_EQ(ranges[0], (CodeRange{7, 100}));
  EXPECT_EQ(ranges[1], (CodeRange{7, 100}));
  EXPECT_EQ(ranges[2], (CodeRange{100, 100}));
  EXPECT_EQ(ranges[8], (CodeRange{100, 100}));
  EXPECT_EQ(ranges[64], (CodeRange{100, 100}));
}

TEST(BrickPacking, SubBricksBeyondTheSamplesAreEmpty) {
  const auto ranges = sub_brick_ranges(numbered_brick({5, 1, 1}));
  EXPECT_EQ(ranges[0], (CodeRange{0, 7 + 9 * 24}));
  EXPECT_EQ(ranges[1], (CodeRange{5, 9 * 25 - 1}));
  EXPECT_EQ(ranges[2], CodeRange());
  EXPECT_EQ(ranges[8], CodeRange());
  EXPECT_EQ(ranges[64], CodeRange());
}

TEST(BrickPacking, ABlockHasAtMostTwoTexelsPerItem) {
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
