#include "model/elevation_range.h"

#include <vector>

#include <gtest/gtest.h>

namespace surfcast::model {
namespace {

ElevationSlab block(double low, double high, uint32_t items) {
  return {{low, high}, items};
}

/// A hilly ground of 1,000,000 points between 100 m and 160 m, in blocks of 20 m.
std::vector<ElevationSlab> ground() {
  return {block(100, 120, 400'000), block(110, 130, 400'000), block(140, 160, 200'000)};
}

TEST(ElevationRange, WithoutOutliersIsTheWhole) {
  const ElevationRange range = elevation_range(ground());
  EXPECT_EQ(range.low, 100);
  EXPECT_EQ(range.high, 160);
}

TEST(ElevationRange, LeavesOutBirdsAboveAndEchoesBelow) {
  std::vector<ElevationSlab> blocks = ground();
  blocks.push_back(block(900, 900, 3));
  blocks.push_back(block(-2000, -400, 40));
  const ElevationRange range = elevation_range(blocks);
  // 5000 points of 400,000 in 20 m lie below 100.25 m, with the 40 echoes, and 5000 of 200,000 above 159.5 m.
  EXPECT_NEAR(range.low, 100.25 - 0.1 * 59.25, 0.01);
  EXPECT_NEAR(range.high, 159.5 + 0.1 * 59.25, 0.01);
}

TEST(ElevationRange, LeavesOutStraysOfThreePointsInAThousand) {
  std::vector<ElevationSlab> blocks = ground();
  blocks.push_back(block(700, 900, 3000));
  EXPECT_LT(elevation_range(blocks).high, 170);
}

TEST(ElevationRange, KeepsATowerOfManyPoints) {
  std::vector<ElevationSlab> blocks = ground();
  blocks.push_back(block(160, 400, 50'000));
  EXPECT_EQ(elevation_range(blocks).high, 400);
}

TEST(ElevationRange, OfAPlaneHasNoWidth) {
  const ElevationRange range = elevation_range(std::vector{block(7, 7, 1000)});
  EXPECT_EQ(range.low, 7);
  EXPECT_EQ(range.high, 7);
}

TEST(ElevationRange, OfAPlaneWithOutliersIsThatOfAll) {
  const ElevationRange range = elevation_range(std::vector{block(7, 7, 100'000), block(90, 91, 2)});
  EXPECT_LE(range.low, 7);
  EXPECT_GE(range.high, 7);
  EXPECT_LT(range.low, range.high);
}

TEST(ElevationRange, OfNothingIsZero) {
  EXPECT_EQ(elevation_range({}).high, 0);
}

}  // namespace
}  // namespace surfcast::model
