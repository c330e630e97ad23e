#include "geometry/camera.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace surfcast::geometry {
namespace {

TEST(CameraFrame, AxesAreRightUpForward) {
  const Result<CameraFrame> frame = make_camera_frame({{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 90}, 200, 100);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->right, glm::dvec3(1, 0, 0));
  EXPECT_EQ(frame->up, glm::dvec3(0, 1, 0));
  EXPECT_EQ(frame->forward, glm::dvec3(0, 0, -1));
  EXPECT_NEAR(frame->eta, 50, 1e-12);  // tan(45 degrees) is 1: half the height
}

TEST(CameraFrame, RayAndProjectionAreInverse) {
  const Result<CameraFrame> frame = make_camera_frame({{3, -2, 5}, {0.5, 1, 0}, {0, 0, 1}, 37}, 640, 480);
  ASSERT_TRUE(frame);
  const glm::dvec2 pixel(17.5, 401.5);
  const glm::dvec2 back = frame->project(frame->ray(pixel) * 7.25);
  EXPECT_NEAR(back.x, pixel.x, 1e-10);
  EXPECT_NEAR(back.y, pixel.y, 1e-10);
}

TEST(CameraFrame, FocalPointIsInTheMiddle) {
  const Camera camera{{448262.31, 5411932.67, 312.45}, {448270.0, 5411900.0, 300.0}, {0, 0, 1}, 45};
  const Result<CameraFrame> frame = make_camera_frame(camera, 101, 77);
  ASSERT_TRUE(frame);
  const glm::dvec2 pixel = frame->project(frame->to_camera(camera.focal_point));
  EXPECT_NEAR(pixel.x, 50.5, 1e-6);
  EXPECT_NEAR(pixel.y, 38.5, 1e-6);
}

TEST(CameraFrame, UpAlongTheViewStillGivesAFrame) {
  const Result<CameraFrame> frame = make_camera_frame({{0, 0, 5}, {0, 0, 0}, {0, 0, 1}, 30}, 10, 10);
  ASSERT_TRUE(frame);
  EXPECT_NEAR(glm::length(frame->right), 1, 1e-12);
  EXPECT_NEAR(glm::dot(frame->up, frame->forward), 0, 1e-12);
}

TEST(CameraFrame, TinyAndHugeScenesAreFine) {
  for (const double scale : {1e-160, 1e-4, 1e5, 1e150}) {
    const Result<CameraFrame> frame =
        make_camera_frame({glm::dvec3(0, 0, 5) * scale, {0, 0, 0}, {0, 1, 0}, 30}, 10, 10);
    ASSERT_TRUE(frame) << scale;
    EXPECT_NEAR(frame->forward.z, -1, 1e-12) << scale;
  }
}

TEST(CameraFrame, WrongCamerasAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(make_camera_frame({{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, 30}, 10, 10));
  EXPECT_FALSE(make_camera_frame({{nan, 0, 1}, {0, 0, 0}, {0, 1, 0}, 30}, 10, 10));
  EXPECT_FALSE(make_camera_frame({{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0}, 10, 10));
  EXPECT_FALSE(make_camera_frame({{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 180}, 10, 10));
  EXPECT_FALSE(make_camera_frame({{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, nan}, 10, 10));
  EXPECT_FALSE(make_camera_frame({{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 30}, 0, 10));
}

}  // namespace
}  // namespace surfcast::geometry
