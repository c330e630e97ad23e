#include "scan/up_axis.h"

#include <gtest/gtest.h>

#include "scan/shapes.h"

namespace surfcast::scan {
namespace {

geometry::Box box_of(const std::vector<glm::dvec3>& positions) {
  geometry::Box box;
  for (const glm::dvec3& p : positions) box.include(p);
  return box;
}

TEST(UpAxisTest, CompactObjectsAreGraphics) {
  EXPECT_FALSE(looks_like_survey({}, box_of(testing::sphere(100, {1, 2, 3}, 0.1))));
  EXPECT_FALSE(looks_like_survey({}, box_of({})));
}

TEST(UpAxisTest, LowAndWideScenesAreSurveys) {
  EXPECT_TRUE(looks_like_survey({}, box_of(testing::box_surface({10, 12, 5}, 1, {0, 0, 0}))));
  EXPECT_FALSE(looks_like_survey({}, box_of(testing::box_surface({10, 5, 12}, 1, {0, 0, 0}))));
}

TEST(UpAxisTest, ProjectedCoordinatesAreASurvey) {
  EXPECT_TRUE(looks_like_survey({}, box_of(testing::sphere(100, {500000, 5000000, 100}, 30))));
}

TEST(UpAxisTest, AttributesOfLidarAreASurvey) {
  const std::vector<ScalarField> scalars = {{"classification", ScalarType::kUint8}};
  EXPECT_TRUE(looks_like_survey(scalars, box_of(testing::sphere(1, {0, 0, 0}, 1))));
}

}  // namespace
}  // namespace surfcast::scan
