#include "selection/block_hull.h"

#include <glm/gtc/constants.hpp>

#include <gtest/gtest.h>

#include "selection/trees.h"
#include "surfel/even_sampling.h"

namespace surfcast::selection {
namespace {

using testing::block_at;
using testing::facing;
using testing::view_from;

bool seen(const ldc::BlockEntry& block, const glm::dvec3& eye = {0, 0, 0}) {
  const ldc::BlockTree tree({block});
  const geometry::CameraFrame frame = view_from(eye);
  return may_be_visible(block_hulls(tree).front(), Frustum(frame, 0, 0, frame.width, frame.height), frame.eye);
}

TEST(BlockHull, BlocksInFrontAreSeenAndOthersAreNot) {
  EXPECT_TRUE(seen(block_at({0, 0, -10}, 1)));
  for (const glm::dvec3 outside : {glm::dvec3(0, 0, 10), glm::dvec3(30, 0, -10), glm::dvec3(-30, 0, -10),
                                   glm::dvec3(0, 30, -10), glm::dvec3(0, -30, -10)}) {
    EXPECT_FALSE(seen(block_at(outside, 1)));
  }
}

TEST(BlockHull, ABlockThatReachesIntoTheViewIsSeen) {
  EXPECT_TRUE(seen(block_at({11, 0, -10}, 1.5)));
}

TEST(BlockHull, DiscsReachFurtherThanCentres) {
  EXPECT_FALSE(seen(block_at({13, 0, -10}, 1, 0.01)));
  EXPECT_TRUE(seen(block_at({13, 0, -10}, 1, 2)));
}

TEST(BlockHull, TheBlockAroundTheEyeIsSeen) {
  EXPECT_TRUE(seen(facing(block_at({0, 0, 0}, 1), {0, 0, -1}, 0.1F)));
}

TEST(BlockHull, ABlockWhoseNormalsAllFaceAwayIsNotSeen) {
  const ldc::BlockEntry block = block_at({0, 0, -10}, 0.5);
  EXPECT_FALSE(seen(facing(block, {0, 0, -1}, 0.3F)));
  EXPECT_TRUE(seen(facing(block, {0, 0, 1}, 0.3F)));
  EXPECT_TRUE(seen(facing(block, {0, 0, -1}, 1.6F))) << "some of its normals face the eye";
  EXPECT_TRUE(seen(block)) << "without a cone nothing faces away";
}

TEST(BlockHull, WorldCoordinatesOfMapsDoNotBlurTheFrustum) {
  const glm::dvec3 eye(448262.31, 5411932.67, 312.45);
  EXPECT_TRUE(seen(block_at(eye + glm::dvec3(0, 0, -0.01), 1e-4, 1e-6), eye));
  EXPECT_FALSE(seen(block_at(eye + glm::dvec3(0, 0, 0.01), 1e-4, 1e-6), eye));
}

TEST(BlockHull, HoldsWhatIsBelowABlockThatIsSmallerThanItsChildren) {
  std::vector<ldc::BlockEntry> blocks{facing(block_at({0, 0, 0}, 1, 0.1), {0, 0, 1}, 0.1F)};
  for (const float side : {-1.0F, 1.0F}) {
    ldc::BlockEntry child = facing(block_at({side * 2, 0, 0}, 1, 0.3), glm::normalize(glm::vec3(side, 0, 1)), 0.2F);
    child.parent = 0;
    blocks.push_back(child);
  }
  const std::vector<BlockHull> hulls = block_hulls(ldc::BlockTree(blocks));
  EXPECT_EQ(hulls[0].centres.min, glm::dvec3(-3, -1, -1));
  EXPECT_EQ(hulls[0].centres.max, glm::dvec3(3, 1, 1));
  EXPECT_EQ(hulls[0].reach, 0.3);
  ASSERT_TRUE(hulls[0].normals);
  EXPECT_NEAR(hulls[0].normals->axis.z, 1, 1e-6);
  EXPECT_NEAR(hulls[0].normals->half_angle, glm::quarter_pi<float>() + 0.2F, 1e-5);
  EXPECT_EQ(hulls[1].centres.min, glm::dvec3(-3, -1, -1));
}

TEST(BlockHull, OneChildWithoutAConeMayFaceAnywhere) {
  std::vector<ldc::BlockEntry> blocks{facing(block_at({0, 0, 0}, 1), {0, 0, 1}, 0.1F), block_at({0, 0, 0}, 1)};
  blocks[1].parent = 0;
  EXPECT_FALSE(block_hulls(ldc::BlockTree(blocks))[0].normals);
}

TEST(ProjectedSpacing, OfASmallBlockStraightAheadIsItsSamplingDistanceOnTheScreen) {
  // Samples 1 apart, 100 away, eta 50.
  EXPECT_NEAR(projected_spacing(block_at({0, 0, -100}, 0.01, surfel::kRadiusOverSpacing), view_from({0, 0, 0})), 0.5,
              1e-3);
}

TEST(ProjectedSpacing, HoldsForEverySampleOfTheBlock) {
  // No segment of length h at any point of the box, in any direction, covers more pixels than the bound.
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 200; ++k) {
    const glm::dvec3 centre(8 * unit(random), 8 * unit(random), -10);
    const ldc::BlockEntry block = block_at(centre, 1.5, 0.00108);
    const double bound = projected_spacing(block, frame);
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 p = centre + 1.5 * glm::dvec3(unit(random), unit(random), unit(random));
      const glm::dvec3 d = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)));
      const glm::dvec2 a = frame.project(frame.to_camera(p));
      if (a.x < 0 || a.y < 0 || a.x > frame.width || a.y > frame.height) continue;
      ASSERT_LE(glm::distance(a, frame.project(frame.to_camera(p + 0.001 * d))), bound * 1.001);
    }
  }
}

TEST(RadiiAtSpacing, HoldThatOfEveryPointOfTheBoxInThePicture) {
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 200; ++k) {
    const glm::dvec3 centre(8 * unit(random), 8 * unit(random), -6);
    const geometry::Box box{centre - 4.0, centre + 4.0};
    const RadiusRange range = radii_at_spacing(box, frame, 3);
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 p = frame.to_camera(centre + 4.0 * glm::dvec3(unit(random), unit(random), unit(random)));
      const glm::dvec2 pixel = frame.project(p);
      if (p.z <= 0 || pixel.x < 0 || pixel.y < 0 || pixel.x > frame.width || pixel.y > frame.height) continue;
      const double radius = surfel::kRadiusOverSpacing * 3 / frame.eta * p.z * p.z / glm::length(p);
      ASSERT_GE(radius, 0.999 * range.least);
      ASSERT_LE(radius, 1.001 * range.largest);
    }
  }
}

TEST(RadiiAtSpacing, AreZeroForEverySurfelAndAroundTheEye) {
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  EXPECT_EQ(radii_at_spacing({{1, 1, -9}, {2, 2, -8}}, frame, 0).largest, 0);
  EXPECT_EQ(radii_at_spacing({glm::dvec3(-1), glm::dvec3(1)}, frame, 2).least, 0);
}

TEST(ProjectedSpacing, IsFiniteAndLargestAroundTheEyeAndBehindIt) {
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const double around = projected_spacing(block_at({0, 0, 0}, 1), frame);
  const double touching = projected_spacing(block_at({0, 0, 1}, 1), frame);
  EXPECT_TRUE(std::isfinite(around));
  EXPECT_EQ(around, touching);
  EXPECT_GE(around, projected_spacing(block_at({0, 0, -1.02}, 1), frame));
  EXPECT_TRUE(std::isfinite(projected_spacing(block_at({0, 0, 5}, 1), frame)));
}

TEST(ProjectedSpacing, FallsWithDistanceAsFarAsOneMayGo) {
  double last = projected_spacing(block_at({0, 0, -2}, 1), view_from({0, 0, 0}));
  for (double distance = 4; distance < 1e9; distance *= 2) {
    const double next = projected_spacing(block_at({0, 0, -distance}, 1), view_from({0, 0, 0}));
    ASSERT_LT(next, last);
    ASSERT_GT(next, 0);
    last = next;
  }
}

}  // namespace
}  // namespace surfcast::selection
