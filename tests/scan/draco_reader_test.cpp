#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/samples.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;
using testing::scalar_values;

TEST(DracoReaderTest, PointsKeepTheirAttributesTogether) {
  for (const bool kd_tree : {false, true}) {
    const Result<testing::WholeScan> points = testing::read_whole(as_bytes(testing::draco_cloud(kd_tree)), "scan.drc");
    ASSERT_TRUE(points) << points.error().message;
    ASSERT_EQ(points->size(), 300u);
    ASSERT_TRUE(points->colors);
    EXPECT_EQ(points->colors->bits, 8);
    const std::vector<uint16_t> quality = scalar_values<uint16_t>(*points, "quality");
    ASSERT_EQ(quality.size(), 300u);
    for (size_t i = 0; i < points->size(); ++i) {  // the kd-tree coder changes the order of points
      const int number = quality[i] / 7;
      EXPECT_NEAR(points->positions[i].z, number * 0.1, 1e-3);
      EXPECT_NEAR(points->positions[i].x, std::cos(number * 0.1), 1e-3);
      EXPECT_EQ(points->colors->values[i], glm::u16vec3(number % 256, 20, 30));
    }
  }
}

TEST(DracoReaderTest, ClaimsOfBillionsOfPointsAreRefusedBeforeMemoryIsTaken) {
  for (const bool kd_tree : {false, true}) {
    std::string text = testing::draco_cloud(kd_tree);
    const size_t count = text.find(std::string("\x2C\1\0\0", 4));  // 300
    ASSERT_NE(count, std::string::npos);
    text[count + 3] = 0x7F;
    const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.drc");
    ASSERT_FALSE(points);
    EXPECT_THAT(points.error().message, ::testing::HasSubstr("claims more points"));
  }
}

}  // namespace
}  // namespace surfcast::scan
