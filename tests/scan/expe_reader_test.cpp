#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string header(int points) {
  return "[Expe/PointSet/Binary/0.1]\nproperty position 12\nproperty radius 4\nproperty normal 12\nproperty weight 2\n"
         "property color 4\nnofpoints " +
         std::to_string(points) + "\ndata\n";
}

testing::Bytes two_points() {
  testing::Bytes file(header(2));
  for (const float at : {1.0F, 2.0F}) {
    file.add(at).add(0.5F).add(-at).add(0.25F).add(0.0F).add(0.0F).add(1.0F).add(uint16_t{9});
    file.add(uint8_t{10}).add(uint8_t{20}).add(uint8_t{30}).add(uint8_t{255});
  }
  return file;
}

TEST(ExpeReaderTest, PropertiesAreReadByTheSizesOfTheHeader) {
  const testing::Bytes file = two_points();
  const Result<testing::WholeScan> points = testing::read_whole(file.bytes(), "surfels.pts");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 0.5, -1), glm::dvec3(2, 0.5, -2)));
  EXPECT_THAT(points->normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1)));
  EXPECT_THAT(points->radii, ElementsAre(0.25F, 0.25F));
  ASSERT_TRUE(points->colors);
  EXPECT_EQ(points->colors->values[1], glm::u16vec3(10, 20, 30));
}

TEST(ExpeReaderTest, EveryTruncationIsOneLineThatNamesTheFile) {
  const std::string whole = two_points().text();
  for (size_t size = 16; size < whole.size(); ++size) {
    const auto points = testing::read_whole(testing::as_bytes(whole.substr(0, size)), "surfels.pts");
    ASSERT_FALSE(points) << size;
    ASSERT_THAT(points.error().message, HasSubstr("surfels.pts: "));
  }
}

std::string expe_error(const std::string& text) {
  const auto points = testing::read_whole(testing::as_bytes(text), "surfels.pts");
  return points ? "" : points.error().message;
}

TEST(ExpeReaderTest, WhatCannotBeReadIsNamed) {
  EXPECT_THAT(expe_error("[Expe/PointSet/ASCII/0.1]\ndata\n"), HasSubstr("as text"));
  EXPECT_THAT(expe_error(header(3) + "x"), HasSubstr("states 3 points"));
  EXPECT_THAT(expe_error("[Expe/PointSet/Binary/0.1]\nproperty position no\ndata\n"), HasSubstr("no size of property"));
  EXPECT_THAT(expe_error("[Expe/PointSet/Binary/0.1]\nnofpoints 18446744073709551615\nproperty position 12\ndata\n"),
              HasSubstr("truncated"));
}

}  // namespace
}  // namespace surfcast::scan
