#include "selection/visible_blocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

BlockEntry block_at(const glm::dvec3& centre, double half_side, double max_radius = 0.01) {
  BlockEntry block;
  block.bounds.include(centre - half_side);
  block.bounds.include(centre + half_side);
  block.max_radius = max_radius;
  return block;
}

BlockEntry facing(BlockEntry block, const glm::vec3& axis, float half_angle) {
  block.normals = NormalCone{axis, half_angle};
  return block;
}

/// From the origin along -z, 90 degrees, square.
CameraFrame view(const glm::dvec3& eye = {0, 0, 0}) {
  return *make_camera_frame({eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 90}, 100, 100);
}

std::vector<size_t> select(const std::vector<BlockEntry>& blocks, const CameraFrame& frame = view()) {
  return select_visible_blocks(blocks, frame, 0, 0, frame.width, frame.height);
}

TEST(VisibleBlocks, BlocksInFrontAreSeenAndOthersAreNot) {
  EXPECT_THAT(select({block_at({0, 0, -10}, 1), block_at({0, 0, 10}, 1), block_at({30, 0, -10}, 1),
                      block_at({-30, 0, -10}, 1), block_at({0, 30, -10}, 1), block_at({0, -30, -10}, 1)}),
              ElementsAre(0));
}

TEST(VisibleBlocks, ABlockThatReachesIntoTheViewIsSeen) {
  EXPECT_THAT(select({block_at({11, 0, -10}, 1.5)}), ElementsAre(0));
}

TEST(VisibleBlocks, DiscsReachFurtherThanCentres) {
  const BlockEntry small = block_at({13, 0, -10}, 1, 0.01);
  const BlockEntry wide = block_at({13, 0, -10}, 1, 2);
  EXPECT_THAT(select({small, wide}), ElementsAre(1));
}

TEST(VisibleBlocks, TheBlockAroundTheEyeIsSeen) {
  EXPECT_THAT(select({facing(block_at({0, 0, 0}, 1), {0, 0, -1}, 0.1F)}), ElementsAre(0));
}

TEST(VisibleBlocks, ABlockWhoseNormalsAllFaceAwayIsNotSeen) {
  const BlockEntry block = block_at({0, 0, -10}, 0.5);
  EXPECT_THAT(select({facing(block, {0, 0, -1}, 0.3F)}), IsEmpty());
  EXPECT_THAT(select({facing(block, {0, 0, 1}, 0.3F)}), ElementsAre(0));
  EXPECT_THAT(select({facing(block, {0, 0, -1}, 1.6F)}), ElementsAre(0)) << "some of its normals face the eye";
}

TEST(VisibleBlocks, WithoutAConeNothingFacesAway) {
  EXPECT_THAT(select({block_at({0, 0, -10}, 0.5)}), ElementsAre(0));
}

TEST(VisibleBlocks, WorldCoordinatesOfMapsDoNotBlurTheFrustum) {
  const glm::dvec3 eye(448262.31, 5411932.67, 312.45);
  EXPECT_THAT(
      select({block_at(eye + glm::dvec3(0, 0, -0.01), 1e-4, 1e-6), block_at(eye + glm::dvec3(0, 0, 0.01), 1e-4, 1e-6)},
             view(eye)),
      ElementsAre(0));
}

TEST(VisibleBlocks, APartOfThePictureSeesItsBlocksOnly) {
  const CameraFrame frame = view();
  const std::vector<BlockEntry> blocks = {block_at({-5, 0, -10}, 0.5), block_at({5, 0, -10}, 0.5)};
  EXPECT_THAT(select_visible_blocks(blocks, frame, 0, 0, 50, 100), ElementsAre(0));
  EXPECT_THAT(select_visible_blocks(blocks, frame, 50, 0, 100, 100), ElementsAre(1));
}

}  // namespace
}  // namespace surfcast
