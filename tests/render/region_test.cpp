#include "render/region.h"

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

/// Halves down to single tiles: counts the pixels of all regions.
int pixels_of_tiles(const Region& region) {
  const std::vector<Region> halves = halves_of(region);
  if (halves.empty()) {
    EXPECT_EQ(region.x % SURFCAST_TILE_WIDTH, 0);
    EXPECT_EQ(region.y % SURFCAST_TILE_HEIGHT, 0);
    EXPECT_LE(region.width, SURFCAST_TILE_WIDTH);
    EXPECT_LE(region.height, SURFCAST_TILE_HEIGHT);
    return region.width * region.height;
  }
  int pixels = 0;
  for (const Region& half : halves) {
    EXPECT_GT(half.width, 0);
    EXPECT_GT(half.height, 0);
    pixels += pixels_of_tiles(half);
  }
  return pixels;
}

TEST(Regions, AreHalvedBetweenTilesDownToOneTile) {
  EXPECT_EQ(pixels_of_tiles({8, 16, 101, 37}), 101 * 37);
  EXPECT_EQ(pixels_of_tiles({0, 0, 3, 50}), 3 * 50);
  EXPECT_TRUE(halves_of({4, 4, 4, 4}).empty());
}

float prefilter_variance(const SurfelFacts& surfels, picture::Filter filter) {
  picture::PictureRequest request;
  request.filter = filter;
  const Result<geometry::CameraFrame> frame = geometry::make_camera_frame({}, 64, 64);
  return frame ? frame_constants(*frame, {0, 0, 64, 64}, request, surfels).filter_.x : 0;
}

TEST(FrameConstants, EvenSamplingsHaveTheVarianceOfWhichOneIsLeft) {
  constexpr double kLeft = 0.776;  // of a Gaussian that is cut at r^2 = 5
  EXPECT_EQ(prefilter_variance({.even = false}, picture::Filter::kEwa), 1);
  EXPECT_NEAR(prefilter_variance({.even = true}, picture::Filter::kEwa) * kLeft, 1, 0.001);
  EXPECT_EQ(prefilter_variance({.even = true}, picture::Filter::kNone),
            prefilter_variance({.even = false}, picture::Filter::kNone));
}

}  // namespace
}  // namespace surfcast::render
