#include "builder/spatial_order.h"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::builder {
namespace {

/// Points along x in disorder, with their x as an attribute.
PartPoints points_at(const std::vector<double>& xs) {
  PartPoints points;
  std::vector<double> values;
  for (const double x : xs) {
    points.cloud.positions.emplace_back(x, 0, 0);
    values.push_back(x);
  }
  points.cloud.scalars.push_back({"x", values});
  points.cloud.sources = {{"scan", 0, xs.size(), std::nullopt}};
  points.inputs = {0};
  points.own = xs.size();
  return points;
}

const geometry::RootCube kRoot{{0, 0, 0}, 16};

/// Returns whether the points are at different positions for sure.
bool sort_spatially(PartPoints& points, const geometry::RootCube& root) {
  const SpatialOrder order = spatial_order(points, root);
  reorder(points.cloud, order.points);
  return order.distinct;
}

TEST(SpatialOrderTest, PointsAreInMortonOrderWithTheirAttributes) {
  PartPoints points = points_at({9, 2, 14, 0, 5, 3});
  EXPECT_TRUE(sort_spatially(points, kRoot));
  const auto& values = std::get<std::vector<double>>(points.cloud.scalars[0].values);
  EXPECT_EQ(values, (std::vector<double>{0, 2, 3, 5, 9, 14}));
  for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ(points.cloud.positions[i].x, values[i]);
}

TEST(SpatialOrderTest, EverySourceKeepsItsRange) {
  PartPoints points = points_at({9, 2, 14, 0, 5, 3});
  points.cloud.sources = {{"scan", 0, 4, std::nullopt}, {"scan", 4, 2, std::nullopt}};  // own points, then the halo
  points.inputs = {0, 0};
  EXPECT_TRUE(sort_spatially(points, kRoot));
  EXPECT_EQ(std::get<std::vector<double>>(points.cloud.scalars[0].values), (std::vector<double>{0, 2, 9, 14, 3, 5}));
}

TEST(SpatialOrderTest, PointsThatMayCoincideAreReported) {
  PartPoints same = points_at({4, 2, 4});
  EXPECT_FALSE(sort_spatially(same, kRoot));
  PartPoints inputs = points_at({4, 2, 1});
  inputs.cloud.sources = {{"a", 0, 2, std::nullopt}, {"b", 2, 1, std::nullopt}};
  inputs.inputs = {0, 1};
  EXPECT_FALSE(sort_spatially(inputs, kRoot)) << "another input may have a point of the first";
}

}  // namespace
}  // namespace surfcast::builder
