#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;
using testing::Bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::scalar_values;

/// Two points with every kind of attribute, between elements to be skipped.
std::string binary_ply(bool big) {
  Bytes file("ply\nformat " + std::string(big ? "binary_big_endian" : "binary_little_endian") +
             " 1.0\ncomment made here\nelement face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\n"
             "element vertex 2\nproperty uchar red\nproperty double z\nproperty float nx\nproperty float y\n"
             "property short confidence\nproperty uchar green\nproperty float ny\nproperty float nz\nproperty int x\n"
             "property uchar blue\nproperty uchar alpha\nproperty float radius\nproperty ushort intensity\n"
             "element tail 1\nproperty list ushort double weights\nend_header\n");
  file.add<uint8_t>(1, big).add<uint8_t>(3, big).add<int32_t>(0, big).add<int32_t>(1, big).add<int32_t>(0, big);
  file.add<uint8_t>(2, big).add<uint8_t>(0, big);
  for (int i = 0; i < 2; ++i) {
    file.add<uint8_t>(static_cast<uint8_t>(10 + i), big).add<double>(0.1 + i, big).add<float>(0.0F, big);
    file.add<float>(2.5F + static_cast<float>(i), big).add<int16_t>(static_cast<int16_t>(-7 - i), big);
    file.add<uint8_t>(20, big).add<float>(3.0F, big).add<float>(4.0F, big).add<int32_t>(-100000 + i, big);
    file.add<uint8_t>(30, big).add<uint8_t>(128, big).add<float>(0.25F, big).add<uint16_t>(65000, big);
  }
  file.add<uint16_t>(1, big).add<double>(0.5, big);
  return file.text();
}

void expect_binary_content(const ScanPoints& points) {
  EXPECT_THAT(points.positions, ElementsAre(glm::dvec3(-100000, 2.5, 0.1), glm::dvec3(-99999, 3.5, 1.1)));
  EXPECT_THAT(points.normals, ElementsAre(glm::vec3(0, 3, 4), glm::vec3(0, 3, 4)));
  ASSERT_TRUE(points.colors);
  EXPECT_EQ(points.colors->bits, 8);
  EXPECT_THAT(points.colors->values, ElementsAre(glm::u16vec3(10, 20, 30), glm::u16vec3(11, 20, 30)));
  EXPECT_THAT(points.radii, ElementsAre(0.25F, 0.25F));
  EXPECT_THAT(scalar_values<int16_t>(points, "confidence"), ElementsAre(-7, -8));
  EXPECT_THAT(scalar_values<uint8_t>(points, "alpha"), ElementsAre(128, 128));
  EXPECT_THAT(scalar_values<uint16_t>(points, "intensity"), ElementsAre(65000, 65000));
  EXPECT_EQ(points.scalars.size(), 3u);
}

TEST(PlyReaderTest, BinaryOfBothByteOrdersReadsEveryProperty) {
  for (const bool big : {false, true}) {
    const Result<testing::WholeScan> points = testing::read_whole(as_bytes(binary_ply(big)), "scan.ply");
    ASSERT_TRUE(points) << points.error().message;
    expect_binary_content(*points);
  }
}

TEST(PlyReaderTest, EveryTruncationFails) {
  for (const bool big : {false, true}) {
    const std::string whole = binary_ply(big);
    for (size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(testing::read_whole(as_bytes(whole).first(size), "scan.ply")) << size;
    }
  }
}

TEST(PlyReaderTest, AsciiReadsAnyOrder) {
  const std::string text =
      "ply\r\nformat ascii 1.0\r\nelement vertex 2\r\nproperty float z\r\nproperty list uchar int parts\r\n"
      "property float x\r\nproperty double y\r\nend_header\r\n3 2 7 8 1 2e0\r\n-3 0 +1.5 -2\r\n";
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.ply");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(1.5, -2, -3)));
  EXPECT_FALSE(points->colors);
}

TEST(PlyReaderTest, AlphaInWideIntegersHasTheTypeOfItsValues) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property int alpha\nend_header\n";
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(head + "1 2 3 255\n1 2 4 0\n"), "scan.ply");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(scalar_values<uint8_t>(*points, "alpha"), ElementsAre(255, 0));
}

TEST(PlyReaderTest, GaussiansAreRefused) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property float f_dc_0\nend_header\n1 2 3 4\n";
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.ply");
  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().kind, ErrorKind::kUnsupported);
  EXPECT_THAT(points.error().message, HasSubstr("3D Gaussians"));
}

TEST(PlyReaderTest, HugeCountsOfElementsAndListsFailAtOnce) {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string tail = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  EXPECT_FALSE(testing::read_whole(as_bytes(head + "18446744073709551615" + tail + std::string(24, '\1')), "scan.ply"));
  EXPECT_FALSE(testing::read_whole(as_bytes(head + "1537228672809129302" + tail + std::string(24, '\1')),
                                   "scan.ply"));  // times 12 wraps
}

/// One point with those properties beside x, y and z.
Result<testing::WholeScan> ascii_point(const std::string& properties, const std::string& values) {
  const std::string text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n" +
                           ("property float z\n" + properties) + "end_header\n1 2 3 " + values + "\n";
  return testing::read_whole(as_bytes(text), "scan.ply");
}

/// A property of that type for each of the names.
std::string properties(const std::string& type, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += "property " + type + " " + name + "\n";
  return text;
}

TEST(PlyReaderTest, ColoursKeepTheDepthOfTheirType) {
  const Result<testing::WholeScan> deep = ascii_point(properties("ushort", {"red", "green", "blue"}), "65535 256 0");
  ASSERT_TRUE(deep && deep->colors);
  EXPECT_EQ(deep->colors->bits, 16);
  EXPECT_THAT(deep->colors->values, ElementsAre(glm::u16vec3(65535, 256, 0)));
  const Result<testing::WholeScan> real = ascii_point(properties("float", {"r", "g", "b"}), "1 0.5 0");
  ASSERT_TRUE(real && real->colors);
  EXPECT_EQ(real->colors->bits, 16);
  EXPECT_THAT(real->colors->values, ElementsAre(glm::u16vec3(65535, 32768, 0)));
  const Result<testing::WholeScan> named =
      ascii_point(properties("uchar", {"diffuse_red", "diffuse_green", "diffuse_blue"}), "1 0 0");
  ASSERT_TRUE(named && named->colors);
  EXPECT_EQ(named->colors->bits, 8);
  EXPECT_THAT(named->colors->values, ElementsAre(glm::u16vec3(1, 0, 0)));
}

TEST(PlyReaderTest, NumbersThatAreNoColoursBecomeTheNearestColour) {
  const Result<testing::WholeScan> points = ascii_point(properties("float", {"red", "green", "blue"}), "-1 nan 0.25");
  ASSERT_TRUE(points && points->colors);
  EXPECT_THAT(points->colors->values, ElementsAre(glm::u16vec3(0, 0, 16384)));
}

TEST(PlyReaderTest, PropertiesOfOneNameAreAllKept) {
  const Result<testing::WholeScan> points =
      ascii_point(properties("int", {"scalar_intensity", "Intensity", "q", "q"}), "5 6 7 8");
  ASSERT_TRUE(points);
  EXPECT_THAT(scalar_values<int32_t>(*points, "intensity"), ElementsAre(5));
  EXPECT_THAT(scalar_values<int32_t>(*points, "Intensity"), ElementsAre(6));
  EXPECT_THAT(scalar_values<int32_t>(*points, "q"), ElementsAre(7));
  EXPECT_THAT(scalar_values<int32_t>(*points, "q_2"), ElementsAre(8));
}

TEST(PlyReaderTest, NamesAreMadePrintable) {
  const Result<testing::WholeScan> points = ascii_point(properties("int", {"q\xFF\1"}), "5");
  ASSERT_TRUE(points);
  EXPECT_EQ(points->scalars.at(0).name, "q??");
}

TEST(PlyReaderTest, ThousandsOfPropertiesAreBeyondTheLimit) {
  std::string values;
  for (int i = 0; i < 20000; ++i) values += "0 ";
  const Result<testing::WholeScan> points =
      ascii_point(properties("float", std::vector<std::string>(20000, "q")), values);
  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().kind, ErrorKind::kLimit);
}

TEST(PlyReaderTest, BadHeadersAreNamed) {
  const auto message = [](const std::string& text) {
    const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.ply");
    return points ? std::string() : points.error().message;
  };
  EXPECT_THAT(message("ply\nelement vertex 1\nend_header\n"), HasSubstr("no format line"));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nelement vertex 1\n"), HasSubstr("no end_header line"));
  EXPECT_THAT(message("ply\nformat ebcdic 1.0\nend_header\n"), HasSubstr("format ebcdic"));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n"), HasSubstr("element vertex -1"));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nproperty float x\nend_header\n"), HasSubstr("property float x"));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nelement face 0\nend_header\n"), HasSubstr("without vertex"));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
              HasSubstr("no x, y and z"));
}

}  // namespace
}  // namespace surfcast::scan
