// The depth of pictures for clients that warp them: that of the front surface, whatever else is asked for. Where things
// are seen through: mixed_depth_gl_test.cpp.

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

constexpr double kRadius = 1;  // of the ball
constexpr double kDistance = 6;
constexpr double kSpacing = 0.1;  // of the surfels of the wall, the coarser ones

class DepthGLTest : public testing::RendererFixture {
 protected:
  /// A ball before a wall that fills the lower half of the picture.
  const testing::ModelPointer& scene() {
    surfel::SurfelCloud cloud = testing::fibonacci_sphere(20000, kRadius, {0, 0, 0}, {200, 90, 20});
    testing::append(cloud, testing::square(120, 12, {0, -6.3, -2}, {0, 0, 1}, {60, 90, 200}));
    return model_of(cloud);
  }

  static picture::PictureRequest view(int width = 320, int height = 200) {
    picture::PictureRequest request;
    request.camera = geometry::Camera{{0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, 40};
    request.width = width;
    request.height = height;
    request.depth_texels = 40;
    return request;
  }

  static picture::PictureRequest in_motion(picture::PictureRequest request) {
    request.normalization = picture::Normalization::kSurfel;
    request.blends_behind = true;
    return request;
  }

  /// The inverse depth of the scene in a pixel; 0: nothing; -1: within two pixels of an outline.
  static double expected(const geometry::CameraFrame& frame, double x, double y) {
    const double here = hit(frame, x, y);
    for (const double dx : {-2.0, 0.0, 2.0}) {
      for (const double dy : {-2.0, 0.0, 2.0}) {
        const double there = hit(frame, x + dx, y + dy);
        if ((there == 0) != (here == 0) || std::abs(there - here) > 0.02) return -1;
      }
    }
    return here;
  }

  static double hit(const geometry::CameraFrame& frame, double x, double y) {
    const glm::dvec3 ray = frame.ray({x, y});
    const double a = glm::dot(ray, ray);
    const double root = kDistance * kDistance - a * (kDistance * kDistance - kRadius * kRadius);
    if (root > 0) return a / (kDistance - std::sqrt(root));
    const double depth = kDistance + 2;
    return ray.y * depth < -0.3 && std::abs(ray.x * depth) < 6 ? 1 / depth : 0;
  }

  /// Compares the depths of a picture with those of the scene: they lie up to two spacings of the surfels behind them.
  static void expect_depths(const picture::Frame& drawn, const picture::PictureRequest& request) {
    const auto frame = geometry::make_camera_frame(*request.camera, request.width, request.height);
    ASSERT_TRUE(frame);
    const picture::DepthMap& map = drawn.depth;
    ASSERT_EQ(map.inverse.size(), static_cast<size_t>(map.width) * static_cast<size_t>(map.height));
    int compared = 0;
    for (int row = 0; row < map.height; ++row) {
      for (int column = 0; column < map.width; ++column) {
        double nearest = 0;
        bool outline = false;
        for (int y = row * map.cell; y < std::min((row + 1) * map.cell, request.height); ++y) {
          for (int x = column * map.cell; x < std::min((column + 1) * map.cell, request.width); ++x) {
            const double inverse = expected(*frame, x + 0.5, y + 0.5);
            outline |= inverse < 0;
            nearest = std::max(nearest, inverse);
          }
        }
        if (outline) continue;
        ++compared;
        const float texel = map.inverse[static_cast<size_t>(row * map.width + column)];
        EXPECT_LE(texel, 1.001 * nearest) << column << " " << row;
        EXPECT_GE(texel, nearest / (1 + 2 * kSpacing * nearest)) << column << " " << row;
      }
    }
    EXPECT_GT(compared, map.width * map.height / 2);
  }
};

TEST_F(DepthGLTest, IsThatOfTheFrontSurfaceAtRestAndInMotion) {
  const testing::ModelPointer& model = scene();
  picture::PictureRequest request = view();
  expect_depths(draw(model, request), request);
  expect_depths(draw(model, in_motion(request)), in_motion(request));
  request.silhouettes = true;
  expect_depths(draw(model, request), request);
}

TEST_F(DepthGLTest, IsThatOfTheFrontSurfaceBesideEyeDomeLighting) {
  picture::PictureRequest request = view();
  request.eye_dome.strength = 1;
  expect_depths(draw(scene(), request), request);
}

TEST_F(DepthGLTest, IsTheSameInPicturesOfSeveralRegions) {
  picture::PictureRequest request = view(2300, 120);  // of which the first is 2048 pixels wide
  request.depth_texels = 100;
  expect_depths(draw(scene(), request), request);
}

TEST_F(DepthGLTest, DoesNotChangeThePicture) {
  const testing::ModelPointer& model = scene();
  picture::PictureRequest request = view();
  request.silhouettes = true;
  for (const bool moving : {false, true}) {
    picture::PictureRequest with = moving ? in_motion(request) : request;
    picture::PictureRequest without = with;
    without.depth_texels = 0;
    const picture::Frame plain = draw(model, without);
    EXPECT_EQ(draw(model, with).image.pixels, plain.image.pixels);
    EXPECT_TRUE(plain.depth.inverse.empty());
  }
}

TEST_F(DepthGLTest, OfAMediumOfSurfelsIsNotKnown) {
  picture::PictureRequest request = view();
  request.xray = picture::XRay::kDensity;
  EXPECT_TRUE(draw(scene(), request).depth.inverse.empty());
}

TEST_F(DepthGLTest, OfBackgroundAloneIsZero) {
  picture::PictureRequest request = view();
  request.camera->focal_point = {0, 0, 2 * kDistance};
  const picture::Frame drawn = draw(scene(), request);
  EXPECT_EQ(std::ranges::max(drawn.depth.inverse), 0);
}

}  // namespace
}  // namespace surfcast::render
