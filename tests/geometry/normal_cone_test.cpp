#include "geometry/normal_cone.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::geometry {
namespace {

TEST(NormalCone, OfOneNormalIsThatNormal) {
  const std::vector<glm::vec3> normals{{0, 0.6f, 0.8f}};
  const auto cone = normal_cone(normals);
  ASSERT_TRUE(cone);
  EXPECT_NEAR(glm::dot(cone->axis, normals[0]), 1, 1e-6);
  EXPECT_LT(cone->half_angle, 1e-6);
}

TEST(NormalCone, OfARingHasTheAngleOfTheRing) {
  std::vector<glm::vec3> normals;
  for (int i = 0; i < 36; ++i) {
    const double a = i * std::numbers::pi / 18;
    normals.emplace_back(0.6 * std::cos(a), 0.6 * std::sin(a), 0.8);
  }
  const auto cone = normal_cone(normals);
  ASSERT_TRUE(cone);
  EXPECT_NEAR(cone->axis.z, 1, 1e-6);
  EXPECT_NEAR(cone->half_angle, std::atan2(0.6, 0.8), 1e-6);
}

TEST(NormalCone, WiderThanAHemisphereIsStillStated) {
  const std::vector<glm::vec3> normals{{0, 0, 1}, {0, 0, 1}, {0.6f, 0, -0.8f}};
  const auto cone = normal_cone(normals);
  ASSERT_TRUE(cone);
  EXPECT_GT(cone->half_angle, std::numbers::pi / 2);
}

TEST(NormalCone, OfOppositeNormalsOrNoneIsNone) {
  EXPECT_FALSE(normal_cone({}));
  const std::vector<glm::vec3> normals{{0, 0, 1}, {0, 0, -1}};
  EXPECT_FALSE(normal_cone(normals));
}

}  // namespace
}  // namespace surfcast::geometry
