#include "selection/visibility.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "selection/trees.h"

namespace surfcast::selection {
namespace {

/// A view of 100 x 100 pixels from the origin along -z; eta is 50. Camera z is -z of the world.
const geometry::CameraFrame kView = testing::view_from({0, 0, 0});

/// The left half of the picture shows a wall at 10, the right half ground at 40.
VisibleDepths wall_on_the_left() {
  VisibleDepths depths(kView.width, kView.height, 0);
  std::vector<DepthRange> row(static_cast<size_t>(kView.width), DepthRange{1 / 40.0F, 1 / 40.0F});
  std::fill_n(row.begin(), row.size() / 2, DepthRange{1 / 10.0F, 1 / 10.0F});
  for (int y = 0; y < kView.height; ++y) depths.enter(0, y, row);
  return depths;
}

/// A row of surfels at this depth, of which this many are in the left half of the picture, and the others in the right.
std::vector<glm::dvec3> row_at(double z, int left, int right) {
  std::vector<glm::dvec3> centres;
  for (int i = 0; i < left; ++i) centres.emplace_back(-0.5 * z * (i + 1) / left, 0, -z);
  for (int i = 0; i < right; ++i) centres.emplace_back(0.5 * z * (i + 1) / right, 0, -z);
  return centres;
}

/// Around all of a row, and high, so that most of its pixels show depths in it.
geometry::Box tall_box(double z) {
  geometry::Box box;
  box.include({-z, -1, -z - 1});
  box.include({z, z, -z + 1});
  return box;
}

void enter(uint32_t block, const std::vector<glm::dvec3>& centres, Visibility& visibility) {
  visibility.enter(block, centres.size(), [&](size_t i) { return centres[i]; });
}

double share_of(const std::vector<glm::dvec3>& centres, const geometry::Box& box) {
  Visibility visibility(wall_on_the_left(), kView, 0);
  enter(7, centres, visibility);
  return visibility.share_of(box, 0, visibility.index_of(7));
}

TEST(Visibility, IsThatOfThePixelsWithoutSurfels) {
  const Visibility visibility(wall_on_the_left(), kView, 0);
  EXPECT_EQ(visibility.index_of(7), Visibility::kNone);
  const geometry::Box box = tall_box(40);
  EXPECT_EQ(visibility.share_of(box, 0, Visibility::kNone), wall_on_the_left().share_of(box, 0, kView));
  EXPECT_GT(visibility.share_of(box, 0, Visibility::kNone), 0.4);
}

TEST(Visibility, CountsTheSurfelsThatAreSeen) {
  EXPECT_NEAR(share_of(row_at(40, 900, 100), tall_box(40)), 0.1, 1e-3);
  EXPECT_NEAR(share_of(row_at(40, 1000, 0), tall_box(40)), 0, 1e-3);
  EXPECT_NEAR(share_of(row_at(40, 700, 300), tall_box(40)), 0.3, 1e-3);
}

TEST(Visibility, IsAtMostThatOfThePixels) {
  geometry::Box behind = tall_box(40);
  behind.max.x = -1;
  EXPECT_EQ(share_of(row_at(40, 0, 1000), behind), 0);
  EXPECT_LE(share_of(row_at(40, 0, 1000), tall_box(40)), wall_on_the_left().share_of(tall_box(40), 0, kView));
}

TEST(Visibility, LeavesOutSurfelsBesideTheBox) {
  geometry::Box right = tall_box(40);
  right.min.x = 0;
  EXPECT_GT(share_of(row_at(40, 900, 100), right), 0.9);
}

TEST(Visibility, FewSurfelsProveNothing) {
  EXPECT_GT(share_of(row_at(40, 15, 0), tall_box(40)), 0.4) << "as many as pixels";
  EXPECT_LT(share_of(row_at(40, 16, 0), tall_box(40)), 0.05);
}

TEST(Visibility, NothingIsSeenOfSurfelsBesideThePicture) {
  std::vector<glm::dvec3> beside;
  for (int i = 0; i < 100; ++i) beside.emplace_back(50 + i, 0, -40);
  geometry::Box box = tall_box(40);
  box.max.x = 200;
  EXPECT_EQ(share_of(beside, box), 0);
  for (glm::dvec3& centre : beside) centre.z = 40;
  box.max.z = 41;
  EXPECT_EQ(share_of(beside, box), 0) << "behind the eye";
}

TEST(Visibility, StatesItsSpacingInThePixelsOfAnotherPicture) {
  geometry::CameraFrame smaller = kView;
  smaller.eta /= 4;
  const Visibility visibility(wall_on_the_left(), kView, 8);
  EXPECT_EQ(visibility.spacing_in(kView), 8);
  EXPECT_EQ(visibility.spacing_in(smaller), 2);
}

TEST(Visibility, SurfelsJustOutsideThePictureCountAsItsBorder) {
  Visibility visibility(wall_on_the_left(), kView, 8);
  std::vector<glm::dvec3> outside;  // 4 pixels beyond the right border
  for (int i = 0; i < 100; ++i) outside.emplace_back(40 * 54.0 / 50, 0, -40);
  enter(0, outside, visibility);
  geometry::Box box = tall_box(40);
  box.max.x = 50;
  EXPECT_GT(visibility.share_of(box, 0, 0), 0.4);
}

TEST(Visibility, IsExactFarFromTheOrigin) {
  const glm::dvec3 far(552436.25, 5801440.5, 145);
  geometry::CameraFrame frame = kView;
  frame.eye += far;
  Visibility visibility(wall_on_the_left(), frame, 0);
  std::vector<glm::dvec3> centres = row_at(40, 900, 100);
  for (glm::dvec3& centre : centres) centre += far;
  enter(0, centres, visibility);
  geometry::Box box = tall_box(40);
  box.min += far;
  box.max += far;
  EXPECT_NEAR(visibility.share_of(box, 0, 0), 0.1, 1e-3);
}

/// Of a large block some surfels are kept: the share stays that of all.
TEST(Visibility, LargeBlocksAreSampledEvenly) {
  std::vector<glm::dvec3> centres = row_at(40, 70'000, 30'000);
  EXPECT_NEAR(share_of(centres, tall_box(40)), 0.3, 1e-3);
}

}  // namespace
}  // namespace surfcast::selection
