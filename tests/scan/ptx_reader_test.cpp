#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::scalar_values;

/// A station turned by 90 degrees about z (x becomes y) and moved to 100 200 300.
const std::string kStation = "2\n1\n100 200 300\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n";

TEST(PtxReaderTest, PointsAreTakenToTheWorldAndRaysWithoutEchoAreNan) {
  const Result<testing::WholeScan> points =
      testing::read_whole(as_bytes(kStation + "1 2 3 0.25 10 20 30\n0 0 0 0.5 0 0 0\n"), "scan.ptx");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->positions[0], glm::dvec3(98, 201, 303));
  EXPECT_TRUE(std::isnan(points->positions[1].x));
  EXPECT_EQ(points->sensor, glm::dvec3(100, 200, 300));
  EXPECT_THAT(scalar_values<double>(*points, "intensity"), ElementsAre(0.25, 0.5));
  ASSERT_TRUE(points->colors);
  EXPECT_EQ(points->colors->values[0], glm::u16vec3(10, 20, 30));
}

TEST(PtxReaderTest, SeveralStationsHaveNoSingleSensor) {
  const std::string station = kStation + "1 2 3 0.25\n4 5 6 0.5\n";
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(station + station), "scan.ptx");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->size(), 4u);
  EXPECT_FALSE(points->sensor);
}

TEST(PtxReaderTest, MissingRowsAreATruncation) {
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(kStation + "1 2 3 0.25\n"), "scan.ptx");
  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("truncated"));
}

TEST(PtxReaderTest, RowsOfFiveNumbersAreRefused) {
  const Result<testing::WholeScan> points =
      testing::read_whole(as_bytes(kStation + "1 2 3 0.25 9\n1 2 3 0.25 9\n"), "scan.ptx");
  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("neither 4 nor 7"));
}

}  // namespace
}  // namespace surfcast::scan
