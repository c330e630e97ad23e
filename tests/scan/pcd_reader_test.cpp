#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/samples.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;
using testing::Bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::pcd_header;
using testing::scalar_values;

const std::string kFields =
    "FIELDS _ z y x rgb normal_x normal_y normal_z label histogram\nSIZE 1 8 4 2 4 4 4 4 8 1\n"
    "TYPE U F F I F F F F U I\nCOUNT 3 1 1 1 1 1 1 1 1 2\n";

void expect_two_points(const Result<testing::WholeScan>& points) {
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(-3, 2.5, 0.1), glm::dvec3(-2, 2.5, 0.2)));
  ASSERT_TRUE(points->colors);
  EXPECT_EQ(points->colors->bits, 8);
  EXPECT_THAT(points->colors->values, ElementsAre(glm::u16vec3(1, 2, 3), glm::u16vec3(1, 2, 3)));
  EXPECT_THAT(points->normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1)));
  EXPECT_THAT(scalar_values<uint64_t>(*points, "label"), ElementsAre(1ULL << 40, 1ULL << 40));
  EXPECT_THAT(scalar_values<int8_t>(*points, "histogram_0"), ElementsAre(-1, -1));
  EXPECT_THAT(scalar_values<int8_t>(*points, "histogram_1"), ElementsAre(5, 5));
  EXPECT_EQ(points->scalars.size(), 3u);
  EXPECT_FALSE(points->sensor);
  EXPECT_TRUE(points->z_up);
}

constexpr uint32_t kColor = 1 << 16 | 2 << 8 | 3;

TEST(PcdReaderTest, BinaryRecordsOfAnyFields) {
  Bytes file(pcd_header(kFields, 2, 1, "binary"));
  for (int i = 0; i < 2; ++i) {
    file.add_text("pad").add<double>(i == 0 ? 0.1 : 0.2).add<float>(2.5F).add<int16_t>(static_cast<int16_t>(i - 3));
    file.add<uint32_t>(kColor).add<float>(0).add<float>(0).add<float>(1);
    file.add<uint64_t>(1ULL << 40).add<int8_t>(-1).add<int8_t>(5);
  }
  expect_two_points(testing::read_whole(file.bytes(), "scan.pcd"));
}

TEST(PcdReaderTest, CompressedFieldsStandOneAfterAnother) {
  Bytes data;
  data.add_text("padpad").add<double>(0.1).add<double>(0.2).add<float>(2.5F).add<float>(2.5F);
  data.add<int16_t>(-3).add<int16_t>(-2).add<uint32_t>(kColor).add<uint32_t>(kColor);
  for (const float v : {0.F, 0.F, 0.F, 0.F, 1.F, 1.F}) data.add<float>(v);
  data.add<uint64_t>(1ULL << 40).add<uint64_t>(1ULL << 40);
  data.add<int8_t>(-1).add<int8_t>(5).add<int8_t>(-1).add<int8_t>(5);
  expect_two_points(testing::read_whole(
      as_bytes(pcd_header(kFields, 2, 1, "binary_compressed") + testing::lzf_block(data.text())), "scan.pcd"));
}

TEST(PcdReaderTest, AsciiNumbersTakeTheTypesOfTheFields) {
  const float color = std::bit_cast<float>(kColor);
  std::ostringstream rows;
  rows.precision(9);
  for (int i = 0; i < 2; ++i) {
    rows << "0 0 0 " << (i == 0 ? 0.1 : 0.2) << " 2.5 " << i - 3 << " " << color << " 0 0 1 1099511627776 -1 5\n";
  }
  expect_two_points(testing::read_whole(as_bytes(pcd_header(kFields, 2, 1, "ascii") + rows.str()), "scan.pcd"));
}

TEST(PcdReaderTest, NamesInTheSpellingOfPdalGetTheirMeaning) {
  const std::string fields =
      "FIELDS X Y Z Intensity ReturnNumber Red Green Blue\nSIZE 4 4 4 2 1 2 2 2\nTYPE F F F U U U U U\n"
      "COUNT 1 1 1 1 1 1 1 1\n";
  const Result<testing::WholeScan> points =
      testing::read_whole(as_bytes(pcd_header(fields, 1, 1, "ascii") + "1 2 3 500 2 256 0 9\n"), "scan.pcd");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 2, 3)));
  EXPECT_THAT(scalar_values<uint16_t>(*points, "intensity"), ElementsAre(500));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "return_number"), ElementsAre(2));
  ASSERT_TRUE(points->colors);
  EXPECT_EQ(points->colors->bits, 16);
}

const std::string kXyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

TEST(PcdReaderTest, OrganisedCloudsComeFromASensorAndMayHoldNan) {
  const Result<testing::WholeScan> points =
      testing::read_whole(as_bytes(pcd_header(kXyz, 1, 3, "ascii") + "nan nan nan\n0 0 1\n0 1 -1\n"), "scan.pcd");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_TRUE(std::isnan(points->positions[0].x));
  EXPECT_EQ(points->sensor, glm::dvec3(0));
  EXPECT_FALSE(points->z_up);
}

TEST(PcdReaderTest, ViewpointIsTheSensor) {
  std::string header = pcd_header(kXyz, 1, 1, "ascii");
  header.replace(header.find("0 0 0 1 0 0 0"), 13, "10 -2 3 1 0 0 0");
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(header + "1 2 3\n"), "scan.pcd");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->sensor, glm::dvec3(10, -2, 3));
}

std::string pcd_message_for(const std::string& text) {
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.pcd");
  return points ? "" : points.error().message;
}

TEST(PcdReaderTest, BadHeadersAreNamed) {
  EXPECT_THAT(pcd_message_for("VERSION .7\nFIELDS x y z\n"), HasSubstr("no DATA line"));
  EXPECT_THAT(pcd_message_for("VERSION .7\nPOINTS 1\nDATA ascii\n"), HasSubstr("no FIELDS line"));
  EXPECT_THAT(pcd_message_for("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("differ in length"));
  EXPECT_THAT(pcd_message_for("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n"), HasSubstr("field z"));
  EXPECT_THAT(pcd_message_for("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n"), HasSubstr("number of points"));
  EXPECT_THAT(pcd_message_for("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 0\nDATA ascii\n"), HasSubstr("no points"));
  EXPECT_THAT(pcd_message_for("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA zip\n"),
              HasSubstr("neither ascii"));
  EXPECT_THAT(pcd_message_for("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 0 0 0\nPOINTS 1\nDATA binary\n"),
              HasSubstr("no values"));
  EXPECT_THAT(pcd_message_for("FIELDS a b c\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
              HasSubstr("x, y and z"));
}

TEST(PcdReaderTest, HugeCountsFailAtOnce) {
  EXPECT_THAT(pcd_message_for(kXyz + "POINTS 18446744073709551615\nDATA binary\n" + std::string(40, 'a')),
              HasSubstr("truncated"));
  EXPECT_THAT(
      pcd_message_for(kXyz + "POINTS 1537228672809129302\nDATA binary\n" + std::string(40, 'a')),  // times 12 wraps
      HasSubstr("truncated"));
  Bytes compressed(kXyz + "POINTS 300000000\nDATA binary_compressed\n");
  compressed.add<uint32_t>(4).add<uint32_t>(3600000000U).add_text("abcd");
  EXPECT_THAT(pcd_message_for(compressed.text()), HasSubstr("damaged"));
}

}  // namespace
}  // namespace surfcast::scan
