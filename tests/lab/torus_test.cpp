#include "lab/torus.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

namespace surfcast::lab {
namespace {

TEST(TorusTest, ARayFromOutsideHitsTheNearSide) {
  const auto hit = ray_surface({0.7, 0.3})({-3, 0, 0}, {2, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(glm::distance(hit->position, {-1, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(glm::distance(hit->normal, {-1, 0, 0}), 0, 1e-6);
}

TEST(TorusTest, ARayThroughTheHoleMisses) {
  EXPECT_FALSE(ray_surface({0.7, 0.3})({0.1, 0, 3}, {0, 0, -1}));
}

TEST(TorusTest, ARayThatLeavesMisses) {
  EXPECT_FALSE(ray_surface({0.7, 0.3})({3, 0, 0}, {1, 0, 0}));
}

TEST(TorusTest, ARayFromTheHoleHitsTheInnerSide) {
  const auto hit = ray_surface({0.7, 0.3})({0, 0, 0}, {0, 1, 0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(glm::distance(hit->position, {0, 0.4, 0}), 0, 1e-6);
}

TEST(TorusTest, SamplesLieOnIt) {
  for (const auto& p : uneven_samples({0.7, 0.3}, 12, 8, 1)) {
    const double off = std::hypot(std::hypot(p.position.x, p.position.y) - 0.7, p.position.z) - 0.3;
    EXPECT_NEAR(off, 0, 1e-12);
  }
}

TEST(TorusTest, APointFoundByARayHasTheCoordinatesItWasMadeWith) {
  const Torus torus;
  const auto point = torus_point(torus, 0.3, 0.6);
  const auto hit = ray_surface(torus)(point.position + point.normal, -point.normal);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->uv.x, 0.3, 1e-5);
  EXPECT_NEAR(hit->uv.y, 0.6, 1e-5);
}

}  // namespace
}  // namespace surfcast::lab
