#include "point_tree/coarse_planes.h"

#include <glm/geometric.hpp>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::point_tree {
namespace {

constexpr float kRadius = 0.8F;

/// Discs on a plane, one in each cell of a grid of unit spacing.
surfel::SurfelCloud make_ground(int side) {
  surfel::SurfelCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-0.2, 0.2);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      cloud.positions.emplace_back(x + within(random), y + within(random), 0);
      cloud.normals.emplace_back(0, 0, 1);
      cloud.radii.push_back(kRadius);
      cloud.scatter.push_back(0);
    }
  }
  return cloud;
}

size_t add_scatter(const glm::dvec3& position, surfel::SurfelCloud& cloud) {
  cloud.positions.push_back(position);
  cloud.normals.emplace_back(1, 0, 0);
  cloud.radii.push_back(0.1F);
  cloud.scatter.push_back(1);
  return cloud.size() - 1;
}

void adopt(surfel::SurfelCloud& cloud) {
  constexpr size_t kAround = 12;
  adopt_planes(estimation::find_neighbourhoods(cloud.positions, cloud.bounds(), kAround), cloud);
}

TEST(CoarsePlanes, ScatterOnTheGroundBecomesADiscOfIt) {
  surfel::SurfelCloud cloud = make_ground(9);
  const size_t added = add_scatter({4.5, 4.5, 0.15 * kRadius}, cloud);
  adopt(cloud);
  EXPECT_FALSE(cloud.is_scatter(added));
  EXPECT_EQ(cloud.normals[added], glm::vec3(0, 0, 1));
  EXPECT_FLOAT_EQ(cloud.radii[added], 0.7F * kRadius);
}

TEST(CoarsePlanes, ScatterAboveTheGroundStays) {
  surfel::SurfelCloud cloud = make_ground(9);
  const size_t above = add_scatter({4.5, 4.5, 0.3 * kRadius}, cloud);
  const size_t beyond = add_scatter({30, 4, 0}, cloud);
  adopt(cloud);
  EXPECT_TRUE(cloud.is_scatter(above));
  EXPECT_TRUE(cloud.is_scatter(beyond)) << "in the plane, but far from all discs";
  EXPECT_FLOAT_EQ(cloud.radii[above], 0.1F);
}

TEST(CoarsePlanes, WhereAWallMeetsTheGroundMostDiscsDecide) {
  surfel::SurfelCloud cloud = make_ground(9);
  // A wall above the edge of the ground, of as many points, which are scatter, and a few discs of its plane.
  std::vector<size_t> foot;
  for (int x = 0; x < 9; ++x) foot.push_back(add_scatter({x, 8.6, 0.05}, cloud));
  for (int z = 2; z < 6; ++z) add_scatter({4, 8.7, 0.9 * z}, cloud);
  adopt(cloud);
  for (const size_t point : foot) EXPECT_EQ(cloud.normals[point], glm::vec3(0, 0, 1)) << point;
}

TEST(CoarsePlanes, ACrownStaysScatter) {
  surfel::SurfelCloud cloud;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 8);
  std::normal_distribution<float> axis;
  for (int i = 0; i < 1000; ++i) {
    add_scatter({place(random), place(random), place(random)}, cloud);
    if (i % 3 != 0) continue;
    // Chance has found planes among the leaves.
    cloud.scatter.back() = 0;
    cloud.normals.back() = glm::normalize(glm::vec3(axis(random), axis(random), axis(random)));
    cloud.radii.back() = kRadius;
  }
  const std::vector<uint8_t> before = cloud.scatter;
  adopt(cloud);
  size_t scatter = 0, adopted = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    scatter += before[i];
    adopted += before[i] - cloud.scatter[i];
  }
  EXPECT_LT(adopted, scatter / 10);
}

TEST(CoarsePlanes, WithoutScatterNothingChanges) {
  surfel::SurfelCloud cloud = make_ground(3);
  const std::vector<float> radii = cloud.radii;
  adopt(cloud);
  EXPECT_EQ(cloud.radii, radii);
  cloud.scatter.clear();
  adopt(cloud);
  EXPECT_TRUE(cloud.scatter.empty());
}

}  // namespace
}  // namespace surfcast::point_tree
