#include "scan/up_axis.h"

#include <gtest/gtest.h>

#include "scan/shapes.h"

namespace surfcast {
namespace {

ScanPoints points_at(std::vector<glm::dvec3> positions) {
  ScanPoints points;
  points.positions = std::move(positions);
  return points;
}

TEST(UpAxisTest, CompactObjectsAreGraphics) {
  EXPECT_FALSE(looks_like_survey(points_at(testing::sphere(100, {1, 2, 3}, 0.1))));
  EXPECT_FALSE(looks_like_survey(points_at({})));
  EXPECT_FALSE(looks_like_survey(points_at({{NAN, 0, 0}})));
}

TEST(UpAxisTest, LowAndWideScenesAreSurveys) {
  EXPECT_TRUE(looks_like_survey(points_at(testing::box_surface({10, 12, 5}, 1, {0, 0, 0}))));
  EXPECT_FALSE(looks_like_survey(points_at(testing::box_surface({10, 5, 12}, 1, {0, 0, 0}))));
}

TEST(UpAxisTest, ProjectedCoordinatesAreASurvey) {
  EXPECT_TRUE(looks_like_survey(points_at(testing::sphere(100, {500000, 5000000, 100}, 30))));
}

TEST(UpAxisTest, AttributesOfLidarAreASurvey) {
  ScanPoints points = points_at(testing::sphere(1, {0, 0, 0}, 1));
  points.scalars.push_back({"classification", std::vector<uint8_t>{2}});
  EXPECT_TRUE(looks_like_survey(points));
}

}  // namespace
}  // namespace surfcast
