#include "geometry/clip.h"

#include <gtest/gtest.h>

namespace surfcast::geometry {
namespace {

const Box kUnit{{0, 0, 0}, {1, 1, 1}};
const Box kFar{{5, 5, 5}, {6, 6, 6}};

TEST(Clip, FacesBelongToTheirBox) {
  const Clip keep{{kUnit}, {}};
  EXPECT_TRUE(keep.shows({1, 0, 0.5}));
  EXPECT_FALSE(keep.shows({1.0000001, 0, 0.5}));
  const Clip hide{{}, {kUnit}};
  EXPECT_FALSE(hide.shows({1, 0, 0.5}));
  EXPECT_TRUE(hide.shows({1.0000001, 0, 0.5}));
}

TEST(Clip, AnyBoxKeepsAndAnyOtherHides) {
  const Clip clip{{kUnit, kFar}, {{{0.4, 0, 0}, {0.6, 1, 1}}}};
  EXPECT_TRUE(clip.shows({0.2, 0.5, 0.5}));
  EXPECT_TRUE(clip.shows({5.5, 5.5, 5.5}));
  EXPECT_FALSE(clip.shows({0.5, 0.5, 0.5}));
  EXPECT_FALSE(clip.shows({3, 3, 3}));
  EXPECT_TRUE(Clip{}.shows({3, 3, 3}));
}

TEST(Clip, BoxesOfPointsAreLeftOutOnlyWhenNothingOfThemIsShown) {
  const Clip keep{{kUnit}, {}};
  EXPECT_TRUE(keep.may_show({{1, 1, 1}, {2, 2, 2}}));
  EXPECT_FALSE(keep.may_show({{1.1, 0, 0}, {2, 2, 2}}));
  const Clip hide{{}, {kUnit}};
  EXPECT_FALSE(hide.may_show({{0, 0, 0}, {1, 1, 1}}));
  EXPECT_TRUE(hide.may_show({{0, 0, 0}, {1, 1, 1.1}}));
}

}  // namespace
}  // namespace surfcast::geometry
