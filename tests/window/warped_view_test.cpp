#include "client/window/warped_view.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "encode/encode_depth.h"

namespace surfcast::window {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr uint8_t kSharp = 200;
constexpr uint8_t kBlurred = 90;

wire::Camera camera(double x) {
  wire::Camera camera;
  camera.mutable_position()->set_x(x);
  camera.mutable_position()->set_z(5);
  camera.mutable_focal_point()->set_x(x);
  camera.mutable_view_up()->set_y(1);
  camera.set_view_angle(40);
  return camera;
}

/// A frame of a wall in the distance of the focal point.
wire::ViewFrame frame(double x, bool moving, bool with_depth = true) {
  wire::ViewFrame frame;
  frame.set_moving(moving);
  *frame.mutable_picture()->mutable_camera() = camera(x);
  if (!with_depth) return frame;
  picture::DepthMap map = picture::empty_depth_map(kWidth, kHeight, 16);
  std::ranges::fill(map.inverse, 0.2F);
  const auto encoded = encode::encode_depth(map, 1000);
  wire::DepthPlane& depth = *frame.mutable_depth();
  depth.set_width(static_cast<uint32_t>(encoded->width));
  depth.set_height(static_cast<uint32_t>(encoded->height));
  depth.set_cell(static_cast<uint32_t>(encoded->cell));
  depth.set_first(encoded->first);
  depth.set_last(encoded->last);
  depth.set_codes(encoded->codes.data(), encoded->codes.size());
  return frame;
}

PixelImage plain(uint8_t value) {
  return {kWidth, kHeight, std::vector<uint8_t>(size_t{4} * kWidth * kHeight, value)};
}

uint8_t middle(const std::optional<PixelImage>& image) {
  return image ? image->pixels.at(size_t{4} * (kHeight / 2 * kWidth + kWidth / 2)) : 0;
}

TEST(WarpedView, ShowsAFrameOfThePresentCameraAsItIs) {
  WarpedView view(wire::Color::default_instance());
  EXPECT_FALSE(view.seen_by(camera(0), kWidth, kHeight));
  view.take(frame(0, false), plain(kSharp));
  EXPECT_FALSE(view.seen_by(camera(0), kWidth, kHeight));
  EXPECT_EQ(view.newest().pixels, plain(kSharp).pixels);
}

TEST(WarpedView, WarpsToACameraThatHasGoneOn) {
  WarpedView view(wire::Color::default_instance());
  view.take(frame(0, false), plain(kSharp));
  const std::optional<PixelImage> seen = view.seen_by(camera(0.1), kWidth, kHeight);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->width, kWidth);
  EXPECT_EQ(middle(seen), kSharp);
}

TEST(WarpedView, ShowsTheFrameAtRestUnderThatInMotion) {
  WarpedView view(wire::Color::default_instance());
  view.take(frame(0, false), plain(kSharp));
  view.take(frame(0.2, true), plain(kBlurred));
  EXPECT_EQ(middle(view.seen_by(camera(0.1), kWidth, kHeight)), kSharp);
}

TEST(WarpedView, ShowsFramesWithoutDepthAsTheyAre) {
  WarpedView view(wire::Color::default_instance());
  view.take(frame(0, false), plain(kSharp));
  view.take(frame(0.2, true, /*with_depth=*/false), plain(kBlurred));
  EXPECT_FALSE(view.seen_by(camera(0.1), kWidth, kHeight));
  EXPECT_EQ(view.newest().pixels.front(), kBlurred);
}

TEST(WarpedView, ADamagedDepthIsNone) {
  WarpedView view(wire::Color::default_instance());
  wire::ViewFrame damaged = frame(0, false);
  damaged.mutable_depth()->set_codes("nothing");
  view.take(damaged, plain(kSharp));
  EXPECT_FALSE(view.seen_by(camera(0.1), kWidth, kHeight));
}

TEST(WarpedView, ACameraThatIsNoneShowsTheFrameAsItIs) {
  WarpedView view(wire::Color::default_instance());
  view.take(frame(0, false), plain(kSharp));
  wire::Camera nowhere = camera(0);
  *nowhere.mutable_focal_point() = nowhere.position();
  EXPECT_FALSE(view.seen_by(nowhere, kWidth, kHeight));
}

}  // namespace
}  // namespace surfcast::window
