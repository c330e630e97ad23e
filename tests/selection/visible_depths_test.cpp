#include "selection/visible_depths.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "selection/trees.h"

namespace surfcast::selection {
namespace {

using testing::view_from;

/// A view of 100 x 100 pixels from the origin along -z; eta is 50. Camera z is -z of the world.
const geometry::CameraFrame kFrame = view_from({0, 0, 0});

geometry::Box box_around(const glm::dvec3& centre, const glm::dvec3& half) {
  geometry::Box box;
  box.include(centre - half);
  box.include(centre + half);
  return box;
}

/// The depths of a picture of all surfels, whose pixels are as `range` says.
template <typename Range>
VisibleDepths depths_of(Range range, double spacing = 0) {
  VisibleDepths depths(kFrame.width, kFrame.height, spacing);
  std::vector<DepthRange> row(static_cast<size_t>(kFrame.width));
  for (int y = 0; y < kFrame.height; ++y) {
    for (int x = 0; x < kFrame.width; ++x) row[static_cast<size_t>(x)] = range(x, y);
    depths.enter(0, y, row);
  }
  return depths;
}

DepthRange surface_at(double z) {
  const auto inverse = static_cast<float>(1 / z);
  return {inverse, inverse};
}

VisibleDepths wall_at(double z) {
  return depths_of([z](int, int) { return surface_at(z); });
}

TEST(VisibleDepths, AWallIsAllThatIsSeenOfItsPixels) {
  const VisibleDepths wall = wall_at(10);
  EXPECT_EQ(wall.share_of(box_around({0, 0, -20}, {1, 1, 1}), 0, kFrame), 0) << "behind it";
  EXPECT_EQ(wall.share_of(box_around({0, 0, -5}, {1, 1, 1}), 0, kFrame), 0) << "what is in front of it would hide it";
  EXPECT_EQ(wall.share_of(box_around({0, 0, -10}, {1, 1, 1}), 0, kFrame), 1);
  EXPECT_EQ(wall.share_of(box_around({0, 0, -10}, {100, 100, 1}), 0, kFrame), 1) << "larger than the picture";
}

TEST(VisibleDepths, TheMarginBelongsToTheBox) {
  const VisibleDepths wall = wall_at(10);
  const geometry::Box box = box_around({0, 0, -12}, {1, 1, 1});
  EXPECT_EQ(wall.share_of(box, 0.99, kFrame), 0);
  EXPECT_EQ(wall.share_of(box, 1.01, kFrame), 1);
}

TEST(VisibleDepths, OfABoxBesideTheEyeEverythingMayBeSeen) {
  const VisibleDepths wall = wall_at(1e-3);
  EXPECT_EQ(wall.share_of(box_around({0, 0, 0}, {1, 1, 1}), 0, kFrame), 1);
  EXPECT_EQ(wall.share_of(box_around({0, 0, -1}, {3, 3, 0.999}), 0.002, kFrame), 1);
}

TEST(VisibleDepths, APixelThatIsNotOpaqueShowsAllBehindItsFront) {
  const VisibleDepths veil = depths_of([](int, int) { return DepthRange{0.1F, 0}; });
  EXPECT_EQ(veil.share_of(box_around({0, 0, -20}, {1, 1, 1}), 0, kFrame), 1);
  EXPECT_EQ(veil.share_of(box_around({0, 0, -5}, {1, 1, 1}), 0, kFrame), 0);
}

TEST(VisibleDepths, WhatABranchLetsThroughIsSeenToTheWallBehindIt) {
  const VisibleDepths branch = depths_of([](int, int) { return DepthRange{1 / 8.0F, 1 / 16.0F}; });
  for (const double z : {-8.0, -12.0, -16.0}) {
    EXPECT_EQ(branch.share_of(box_around({0, 0, z}, {0.5, 0.5, 0.5}), 0, kFrame), 1) << z;
  }
  EXPECT_EQ(branch.share_of(box_around({0, 0, -20}, {0.5, 0.5, 0.5}), 0, kFrame), 0);
}

TEST(VisibleDepths, WhereNothingIsDrawnNothingIsSeen) {
  const VisibleDepths sky = depths_of([](int, int) { return DepthRange{}; });
  EXPECT_EQ(sky.share_of(box_around({0, 0, -20}, {1, 1, 1}), 0, kFrame), 0);
}

TEST(VisibleDepths, ACoarsePictureIsAsExactAsItsSpacing) {
  // At a depth of 10, eight pixels of this view are 1.6.
  const VisibleDepths coarse = depths_of([](int, int) { return surface_at(10); }, 8);
  EXPECT_EQ(coarse.share_of(box_around({0, 0, -12.5}, {1, 1, 1}), 0, kFrame), 1);
  EXPECT_EQ(coarse.share_of(box_around({0, 0, -13.5}, {1, 1, 1}), 0, kFrame), 0);
  EXPECT_EQ(coarse.share_of(box_around({0, 0, -7.8}, {1, 1, 1}), 0, kFrame), 1);
  EXPECT_EQ(coarse.share_of(box_around({0, 0, -7.4}, {1, 1, 1}), 0, kFrame), 0);
}

TEST(VisibleDepths, APictureLargerThanItsCellsKeepsWhatAnyPixelShows) {
  constexpr int kSide = 4000;
  const geometry::CameraFrame frame =
      *geometry::make_camera_frame({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90}, kSide, kSide);
  VisibleDepths depths(kSide, kSide, 0);
  const std::vector<DepthRange> wall(kSide, surface_at(10));
  for (int y = 0; y < kSide; ++y) depths.enter(0, y, wall);
  const geometry::Box behind = box_around({0, 0, -20}, {0.01, 0.01, 0.1});
  EXPECT_EQ(depths.share_of(behind, 0, frame), 0);
  depths.enter(kSide / 2, kSide / 2, std::vector<DepthRange>{surface_at(20)});
  EXPECT_GT(depths.share_of(behind, 0, frame), 0);
}

/// The share of the pixels of the box's rectangle that show a depth of the box, by its definition.
double reference_share(const glm::dvec3& centre, const glm::dvec3& half, const std::vector<double>& depths) {
  glm::dvec2 low(1e9);
  glm::dvec2 high(-1e9);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at = centre + half * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const glm::dvec2 pixel(50 + 50 * at.x / -at.z, 50 - 50 * at.y / -at.z);
    low = glm::min(low, pixel);
    high = glm::max(high, pixel);
  }
  int seen = 0;
  int all = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      if (x + 1 <= low.x || x > high.x || y + 1 <= low.y || y > high.y) continue;
      ++all;
      const double z = depths[static_cast<size_t>(y) * 100 + static_cast<size_t>(x)];
      seen += z >= -centre.z - half.z && z <= -centre.z + half.z ? 1 : 0;
    }
  }
  return all == 0 ? -1 : static_cast<double>(seen) / all;
}

TEST(VisibleDepths, TheShareOfRandomBoxesIsThatOfTheirPixels) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  int partly = 0;
  for (int k = 0; k < 500; ++k) {
    std::vector<double> z(100 * 100);
    const double slope = 0.05 * unit(random);
    const int step = 50 + static_cast<int>(40 * unit(random));
    for (int i = 0; i < 100 * 100; ++i) {
      const int x = i % 100;
      const int y = i / 100;
      z[static_cast<size_t>(i)] = 10 + slope * (y - 50) + (x < step ? 0 : 4);
    }
    const VisibleDepths depths =
        depths_of([&](int x, int y) { return surface_at(z[static_cast<size_t>(y * 100 + x)]); });
    const glm::dvec3 centre(6 * unit(random), 6 * unit(random), -12 + 3 * unit(random));
    const glm::dvec3 half = glm::dvec3(1.5) + glm::dvec3(unit(random), unit(random), unit(random));
    const double expected = reference_share(centre, half, z);
    if (expected < 0) continue;
    partly += expected > 0 && expected < 1 ? 1 : 0;
    // Single precision, and the pixels at borders.
    EXPECT_NEAR(depths.share_of(box_around(centre, half), 0, kFrame), expected, 0.01);
  }
  EXPECT_GT(partly, 100);
}

}  // namespace
}  // namespace surfcast::selection
