#include "render/depth_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

/// The depth at which a slice begins; 0 for the first one.
double begin_of(const DepthSlices& slices, int slice) {
  return slice == 0 ? 0 : 1 / static_cast<double>(std::bit_cast<float>(slices.second - (slice - 1) * slices.step));
}

TEST(DepthSlices, AreSimilarStepsOfTheLogarithmOfDepthBetweenAlmostAllItems) {
  const DepthSlices slices = depth_slices(std::vector{DepthRange{2, 32, 100000}}, false, 1000);
  ASSERT_EQ(slices.count, SURFCAST_SLICES);
  EXPECT_NEAR(begin_of(slices, 1), 2, 0.2);
  EXPECT_NEAR(begin_of(slices, slices.count - 1), 26, 3);
  for (int i = 1; i + 1 < slices.count; ++i) {
    EXPECT_NEAR(std::log2(begin_of(slices, i + 1) / begin_of(slices, i)), 4.0 / (SURFCAST_SLICES - 1), 0.13) << i;
  }
}

TEST(DepthSlices, FewItemsFarFromTheOthersDoNotWidenThem) {
  const std::vector<DepthRange> ranges{{0.001, 0.002, 100}, {10, 11, 50000}, {4000, 9000, 100}};
  const DepthSlices slices = depth_slices(ranges, false, 100);
  EXPECT_NEAR(begin_of(slices, 1), 10, 0.2);
  EXPECT_NEAR(begin_of(slices, slices.count - 1), 11, 0.2);
}

TEST(DepthSlices, AreInFrontOfTheEyeWhateverTheRanges) {
  const std::vector<DepthRange> ranges{{-1, 2, 5000}, {1, 1, 20000}, {700, 9000, 40000}, {0, 1e-9, 300}, {-5, -2, 8}};
  const DepthSlices slices = depth_slices(ranges, false, 100);
  EXPECT_GT(slices.step, 0);
  EXPECT_GT(slices.second - (slices.count - 2) * slices.step, 0);
  EXPECT_GT(depth_slices(std::vector{DepthRange{3, 3, 9999}}, false, 1).step, 0);
}

TEST(DepthSlices, DoNotDependOnTheOrderOfBlocks) {
  std::vector<DepthRange> ranges;
  for (int i = 1; i < 60; ++i) ranges.push_back({0.3 * i, 0.37 * i * i, static_cast<uint64_t>(10007 * i % 977)});
  const DepthSlices before = depth_slices(ranges, false, 50);
  std::ranges::reverse(ranges);
  EXPECT_EQ(depth_slices(ranges, false, 50).second, before.second);
  EXPECT_EQ(depth_slices(ranges, false, 50).step, before.step);
}

TEST(DepthSlices, AreOneWhereListsAreShort) {
  EXPECT_EQ(depth_slices(std::vector{DepthRange{1, 2, 7999}}, false, 1000).count, 1);
  EXPECT_EQ(depth_slices(std::vector{DepthRange{1, 2, 8000}}, false, 1000).count, 16);
  EXPECT_EQ(depth_slices(std::vector{DepthRange{1, 2, 8000}}, true, 1000).count, 1);
  EXPECT_EQ(depth_slices({}, false, 1000).count, 1);
  EXPECT_EQ(depth_slices(std::vector{DepthRange{-3, -2, 1000000}}, false, 10).count, 1);
}

}  // namespace
}  // namespace surfcast::render
