#include "volume/packing.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <numeric>
#include <random>

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

/// Weights of Catmull and Rom for four samples, at the fraction x between the second and the third.
std::array<double, 4> cubic_weights(double x) {
  return {0.5 * ((2 - x) * x - 1) * x, 0.5 * ((3 * x - 5) * x * x + 2), 0.5 * ((4 - 3 * x) * x + 1) * x,
          0.5 * (x - 1) * x * x};
}

/// The code at a place in stored indices, in double precision.
double reconstructed(const Brick& brick, const glm::dvec3& at) {
  const glm::u32vec3 size = stored_size(brick.header.count);
  const glm::dvec3 cell = glm::clamp(glm::floor(at), glm::dvec3(1), glm::dvec3(size - 3U));
  const glm::u32vec3 first(cell - 1.0);
  std::array<std::array<double, 4>, 3> weights{};
  for (int axis = 0; axis < 3; ++axis) weights.at(static_cast<size_t>(axis)) = cubic_weights(at[axis] - cell[axis]);
  double sum = 0;
  for (uint32_t k = 0; k < 4; ++k) {
    for (uint32_t j = 0; j < 4; ++j) {
      for (uint32_t i = 0; i < 4; ++i) {
        const size_t sample = (size_t{first.z + k} * size.y + first.y + j) * size.x + first.x + i;
        sum += weights[0].at(i) * weights[1].at(j) * weights[2].at(k) * brick.codes.at(sample);
      }
    }
  }
  return sum;
}

size_t sub_brick(uint32_t i, uint32_t j, uint32_t k) {
  return (size_t{k} * kSubBricks + j) * kSubBricks + i;
}

TEST(BrickPacking, RangesOfSubBricksHoldWhatReconstructionFinds) {
  std::mt19937 random(7);
  for (const glm::u32vec3 count : {glm::u32vec3(32), glm::u32vec3(5, 1, 9)}) {
    Brick brick = numbered_brick(count);
    for (uint16_t& code : brick.codes)
      code = static_cast<uint16_t>(random() % 3 == 0 ? 20000 + random() % 9000 : 30000);
    const std::vector<CodeRange> ranges = sub_brick_ranges(brick);
    ASSERT_EQ(ranges.size(), kAllSubBricks);
    for (int n = 0; n < 20000; ++n) {
      // From half a sample before the first to half a sample before the next brick, or the last sample.
      glm::dvec3 own;
      for (int axis = 0; axis < 3; ++axis) {
        const double end = count[axis] == 32 ? 31.5 : static_cast<double>(count[axis]) - 1;
        own[axis] = -0.5 + (end + 0.5) * static_cast<double>(random() % 1001) / 1000;
      }
      const glm::u32vec3 sub(glm::max(own, 0.0) / static_cast<double>(kSubBrickSamples));
      const CodeRange range = ranges[sub_brick(sub.x, sub.y, sub.z)];
      const double found = reconstructed(brick, own + double{kHaloBefore});
      ASSERT_GE(found, range.low - 0.01);
      ASSERT_LE(found, range.high + 0.01);
    }
  }
}

TEST(BrickPacking, RangesOfSubBricksAreNarrow) {
  Brick brick = numbered_brick(glm::u32vec3(32));
  std::ranges::fill(brick.codes, uint16_t{100});
  // Sample (5, 0, 0): stored index (7, 2, 2).
  brick.codes[(size_t{2} * 36 + 2) * 36 + 7] = 7;
  const std::vector<CodeRange> ranges = sub_brick_ranges(brick);
  EXPECT_EQ(ranges[sub_brick(2, 0, 0)].low, 7);
  EXPECT_LE(ranges[sub_brick(2, 0, 0)].high, 116);
  EXPECT_GT(ranges[sub_brick(1, 0, 0)].low, 80);  // beside the sample's cells: a sixth of the difference
  EXPECT_EQ(ranges[sub_brick(0, 0, 0)], (CodeRange{100, 100}));
  EXPECT_EQ(ranges[sub_brick(4, 0, 0)], (CodeRange{100, 100}));
  EXPECT_EQ(ranges[sub_brick(2, 2, 0)], (CodeRange{100, 100}));
  EXPECT_EQ(ranges[sub_brick(2, 0, 2)], (CodeRange{100, 100}));
}

TEST(BrickPacking, WhatIsBeyondTheCodesIsAtTheirEnds) {
  Brick brick = numbered_brick(glm::u32vec3(8));
  for (size_t i = 0; i < brick.codes.size(); ++i) brick.codes[i] = i % 2 == 0 ? 0 : 0xffff;
  for (uint32_t i = 0; i < 4; ++i) EXPECT_EQ(sub_brick_ranges(brick)[i], (CodeRange{0, 0xffff}));
}

TEST(BrickPacking, SubBricksBeyondTheSamplesAreEmpty) {
  const std::vector<CodeRange> ranges = sub_brick_ranges(numbered_brick({5, 1, 1}));
  for (uint32_t i = 0; i < 3; ++i) EXPECT_LE(ranges[sub_brick(i, 0, 0)].low, ranges[sub_brick(i, 0, 0)].high);
  EXPECT_EQ(ranges[sub_brick(3, 0, 0)], CodeRange());
  EXPECT_EQ(ranges[sub_brick(0, 1, 0)], CodeRange());
  EXPECT_EQ(ranges[sub_brick(0, 0, 1)], CodeRange());
}

TEST(BrickPacking, ABlockHasAtMostTwoTexelsPerItem) {
  for (uint32_t n = 1; n <= kBrickSamples; ++n) {
    for (const glm::u32vec3 count : {glm::u32vec3(n, 1, 1), glm::u32vec3(1, n, n), glm::u32vec3(n)}) {
      EXPECT_LE(packed_texels(count), 2 * brick_items(count));
      EXPECT_LE(brick_items(count), 32768U);
      EXPECT_GE(brick_items(count), count.x * count.y * count.z);
      EXPECT_GE(most_texels(brick_items(count)), packed_texels(count));
    }
  }
}

TEST(BrickPacking, AWholeBrickIsCountedAsTheTexelsThatItHas) {
  const glm::u32vec3 whole(kBrickSamples);
  EXPECT_EQ(most_texels(brick_items(whole)), packed_texels(whole));
  EXPECT_LT(most_texels(brick_items(whole)), brick_items(whole));
  EXPECT_EQ(most_texels(0), 0U);
  EXPECT_EQ(most_texels(brick_items(whole) + 1), 0U);
}

}  // namespace
}  // namespace surfcast::volume
