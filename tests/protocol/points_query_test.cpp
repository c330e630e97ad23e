#include "protocol/points_query.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace surfcast::protocol {
namespace {

wire::GetPoints region() {
  wire::GetPoints points;
  points.set_model("church");
  return points;
}

TEST(PointsQuery, SetsEveryField) {
  const auto points = parse_points_query(
      "church",
      "box=1,2,3,4,5,6;-1,-2,-3,0,0,0&corridor=2.5,0,0,1,0,1,9;4,5,6,7,8@-1,3&classes=2,6&every=10&format=LAZ&"
      "max_points=7&count=1&normals=1&coordinates=world");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->model(), "church");
  ASSERT_EQ(points->boxes_size(), 2);
  EXPECT_EQ(points->boxes(0).max().z(), 6);
  EXPECT_EQ(points->boxes(1).min().y(), -2);
  ASSERT_EQ(points->corridors_size(), 2);
  EXPECT_EQ(points->corridors(0).line_size(), 6);
  EXPECT_EQ(points->corridors(0).width(), 2.5);
  EXPECT_FALSE(points->corridors(0).has_low());
  EXPECT_EQ(points->corridors(1).high(), 3);
  EXPECT_EQ(points->classes_size(), 2);
  EXPECT_EQ(points->every(), 10U);
  EXPECT_EQ(points->format(), wire::POINT_FORMAT_LAZ);
  EXPECT_EQ(points->max_points(), 7U);
  EXPECT_TRUE(points->only_count());
  EXPECT_TRUE(points->normals());
  EXPECT_TRUE(points->world_coordinates());
}

TEST(PointsQuery, WithoutParametersIsAllOfTheModelAsText) {
  const auto points = parse_points_query("church", "");
  ASSERT_TRUE(points);
  EXPECT_EQ(points->format(), wire::POINT_FORMAT_CSV);
  EXPECT_EQ(points->boxes_size() + points->corridors_size() + points->classes_size(), 0);
  EXPECT_FALSE(points->world_coordinates());
}

TEST(PointsQuery, FormatsHaveTheNamesOfTheirExtensions) {
  for (const char* name : {"las", "laz", "ply", "csv", "npy"}) {
    const auto format = parse_point_format(name);
    ASSERT_TRUE(format) << name;
    EXPECT_EQ(name_of(*format), name);
  }
  EXPECT_EQ(parse_point_format("e57").error().message, "'e57' is not a format of points: las, laz, ply, csv, npy");
}

TEST(PointsQuery, MessagesAreHeldToTheSameLimits) {
  wire::GetPoints many = region();
  for (int i = 0; i < kMaxRegionBoxes; ++i) many.add_boxes()->mutable_max()->set_x(i);
  for (wire::Box& box : *many.mutable_boxes()) box.mutable_min();
  EXPECT_TRUE(check_points(many));
  many.add_boxes();
  EXPECT_FALSE(check_points(many));
  wire::GetPoints long_line = region();
  wire::Corridor* corridor = long_line.add_corridors();
  corridor->set_width(1);
  for (int i = 0; i < 2 * kMaxCorridorCorners; ++i) corridor->add_line(i);
  EXPECT_TRUE(check_points(long_line));
  corridor->add_line(1);
  EXPECT_FALSE(check_points(long_line)) << "half a corner";
  corridor->add_line(1);
  EXPECT_FALSE(check_points(long_line));
}

TEST(PointsQuery, NumbersThatMeanNothingAreRefusedInMessages) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double wrong : {none, infinite}) {
    wire::GetPoints points = region();
    points.add_boxes()->mutable_max()->set_y(wrong);
    points.mutable_boxes(0)->mutable_min();
    EXPECT_FALSE(check_points(points)) << wrong;
    points = region();
    wire::Corridor* corridor = points.add_corridors();
    for (const double number : {0.0, 0.0, 1.0, 1.0}) corridor->add_line(number);
    corridor->set_width(wrong);
    EXPECT_FALSE(check_points(points)) << wrong;
    corridor->set_width(1);
    EXPECT_TRUE(check_points(points));
    corridor->set_line(2, wrong);
    EXPECT_FALSE(check_points(points)) << wrong;
  }
  wire::GetPoints points = region();
  points.add_classes(256);
  EXPECT_FALSE(check_points(points));
  points = region();
  points.set_format(static_cast<wire::PointFormat>(9));
  EXPECT_FALSE(check_points(points));
  points.Clear();
  EXPECT_EQ(check_points(points).error().message, "a model must be named");
}

}  // namespace
}  // namespace surfcast::protocol
