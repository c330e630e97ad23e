#include "geometry/camera.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace surfcast {
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

TEST(FitCamera, WholeBoxIsInView) {
  Box box;
  box.include({100, 200, 300});
  box.include({104, 207, 301});
  for (const double aspect : {0.3, 1.0, 2.5}) {
    for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0)}) {
      const int height = 400;
      const int width = static_cast<int>(height * aspect);
      const Result<CameraFrame> frame = make_camera_frame(fit_camera(box, up, aspect), width, height);
      ASSERT_TRUE(frame);
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                           (corner & 4) ? box.max.z : box.min.z);
        const glm::dvec3 q = frame->to_camera(p);
        ASSERT_GT(q.z, 0);
        const glm::dvec2 pixel = frame->project(q);
        EXPECT_TRUE(pixel.x >= 0 && pixel.x <= width && pixel.y >= 0 && pixel.y <= height);
      }
    }
  }
}

TEST(FitCamera, TheBoxNearlyFillsThePicture) {
  Box box;
  box.include({0, 0, 0});
  box.include({30, 2, 1});
  const Result<CameraFrame> frame = make_camera_frame(fit_camera(box, {0, 0, 1}, 2), 800, 400);
  ASSERT_TRUE(frame);
  Box seen;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) ? 30 : 0, (corner & 2) ? 2 : 0, (corner & 4) ? 1 : 0);
    seen.include(glm::dvec3(frame->project(frame->to_camera(p)), 0));
  }
  EXPECT_GT(std::max(seen.size().x / 800, seen.size().y / 400), 0.75);
}

TEST(FitCamera, TheEyeStandsWhereTheSurfaceShowsItsFront) {
  Box box;
  box.include({-1, -1, -1});
  box.include({1, 1, 1});
  for (const glm::dvec3 facing : {glm::dvec3(0, 0, -0.9), glm::dvec3(0, 0.9, 0), glm::dvec3(-0.9, 0, 0)}) {
    const Camera camera = fit_camera(box, {0, 0, 1}, 1, 30, facing);
    EXPECT_GT(glm::dot(glm::normalize(camera.position), facing), 0.1);
  }
}

TEST(FitCamera, APointHasAViewToo) {
  Box box;
  box.include({5, 6, 7});
  EXPECT_TRUE(make_camera_frame(fit_camera(box, {0, 1, 0}, 1), 10, 10));
}

}  // namespace
}  // namespace surfcast
