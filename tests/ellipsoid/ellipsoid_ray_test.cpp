#include "kinds/ellipsoid_ray.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::kinds {
namespace {

geometry::CameraFrame frame_of(int side) {
  return *geometry::make_camera_frame({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60}, side, side);
}

TEST(EllipsoidOnRaysTest, ASphereIsHitWhereItIs) {
  const EllipsoidOnRays ball({0, 0, 5}, glm::dmat3(1), glm::dvec3(1));
  const auto middle = ball.on_ray({0, 0, 1});
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->depth, 4, 1e-15);
  EXPECT_EQ(middle->form, 0);
  EXPECT_FALSE(ball.on_ray({0.25, 0, 1})) << "the tangent has the slope 1 / sqrt(24)";
  EXPECT_TRUE(ball.on_ray({0.204, 0, 1}));
  EXPECT_FALSE(EllipsoidOnRays({0, 0, -5}, glm::dmat3(1), glm::dvec3(1)).on_ray({0, 0, 1})) << "behind the eye";
  EXPECT_FALSE(EllipsoidOnRays({0, 0, 0.5}, glm::dmat3(1), glm::dvec3(1)).on_ray({0, 0, 1})) << "around the eye";
}

TEST(EllipsoidOnRaysTest, PointsOfTheSurfaceAreHitAndWithinTheBounds) {
  std::mt19937 random(2);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const geometry::CameraFrame frame = frame_of(400);
  const PixelRange all{{0, 0}, {399, 399}};
  for (int i = 0; i < 300; ++i) {
    const glm::dmat3 axes =
        glm::mat3_cast(glm::normalize(glm::dquat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))));
    const glm::dvec3 semi_axes(1, std::pow(10, uniform(-5, 0)), std::pow(10, uniform(-5, 0)));
    const glm::dvec3 centre(uniform(-1, 1), uniform(-1, 1), uniform(1.02, 5));
    const EllipsoidOnRays shape(centre, axes, semi_axes);
    const PixelRange pixels = shape.pixels(frame, all);
    for (int k = 0; k < 50; ++k) {
      const glm::dvec3 unit = glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
      const glm::dvec3 point = centre + axes * (semi_axes * unit);
      const glm::dvec3 normal = glm::normalize(axes * (unit / semi_axes));
      const glm::dvec2 at = frame.project(point);
      if (at.x < 0 || at.y < 0 || at.x >= 400 || at.y >= 400) continue;
      const glm::ivec2 nearest(glm::clamp(glm::round(at - 0.5), glm::dvec2(0), glm::dvec2(399)));
      EXPECT_TRUE(nearest.x >= pixels.first.x - 1 && nearest.x <= pixels.last.x + 1);
      EXPECT_TRUE(nearest.y >= pixels.first.y - 1 && nearest.y <= pixels.last.y + 1);
      if (glm::dot(normal, point) > -1e-3 * glm::length(point)) continue;  // away from the eye
      const auto hit = shape.on_ray(point / point.z);
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->depth, point.z, 1e-6);
      EXPECT_NEAR(glm::length(hit->normal), 1, 1e-12);
      const bool round = semi_axes.y > 0.1 && semi_axes.z > 0.1;
      EXPECT_TRUE(!round || glm::dot(hit->normal, normal) > 1 - 1e-6);
    }
  }
}

TEST(EllipsoidOnRaysTest, ADiscIsHitOnItsPlane) {
  const EllipsoidOnRays disc({0, 0, 5}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 1, 0});
  const auto hit = disc.on_ray({0.1, 0, 1});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->depth, 5, 1e-9);
  EXPECT_NEAR(hit->normal.z, -1, 1e-9);
  EXPECT_FALSE(disc.on_ray({0.21, 0, 1}));
}

}  // namespace
}  // namespace surfcast::kinds
