#include "render/depth_slices.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

/// The share of items of one range, spread evenly over the logarithm of depth, that is nearer than an inverse depth.
double share_nearer(const DepthRange& range, double inverse_depth) {
  return std::clamp(std::log(1 / inverse_depth / range.nearest) / std::log(range.farthest / range.nearest), 0.0, 1.0);
}

TEST(DepthSlices, HoldSimilarNumbersOfItems) {
  const DepthRange range{2, 32, 100000};
  const DepthSlices slices = depth_slices(std::vector{range}, 1000);
  ASSERT_EQ(slices.count, 32u);
  for (uint32_t i = 1; i < slices.count; ++i) {
    EXPECT_NEAR(share_nearer(range, slices.near.at(i)), i / 32.0, 0.01) << i;
  }
}

TEST(DepthSlices, BeginAtTheEyeAndDescend) {
  const std::vector<DepthRange> ranges{{-1, 2, 5000}, {1, 1, 20000}, {700, 9000, 40000}, {0, 1e-9, 300}, {-5, -2, 8}};
  const DepthSlices slices = depth_slices(ranges, 100);
  EXPECT_TRUE(std::isinf(slices.near[0]));
  for (uint32_t i = 1; i < slices.count; ++i) {
    EXPECT_GT(slices.near.at(i), 0);
    EXPECT_LE(slices.near.at(i), slices.near.at(i - 1));
  }
}

TEST(DepthSlices, DoNotDependOnTheOrderOfBlocks) {
  std::vector<DepthRange> ranges;
  for (int i = 1; i < 60; ++i) ranges.push_back({0.3 * i, 0.37 * i * i, static_cast<uint64_t>(10007 * i % 977)});
  const DepthSlices before = depth_slices(ranges, 50);
  std::ranges::reverse(ranges);
  EXPECT_EQ(depth_slices(ranges, 50).near, before.near);
}

TEST(DepthSlices, AreOneWhereListsAreShort) {
  EXPECT_EQ(depth_slices(std::vector{DepthRange{1, 2, 1999}}, 1000).count, 1u);
  EXPECT_EQ(depth_slices(std::vector{DepthRange{1, 2, 2000}}, 1000).count, 2u);
  EXPECT_EQ(depth_slices({}, 1000).count, 1u);
  EXPECT_EQ(depth_slices(std::vector{DepthRange{-3, -2, 1000000}}, 10).count, 1u);
}

}  // namespace
}  // namespace surfcast::render
