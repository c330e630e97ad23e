#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/e57_scans.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::E57File;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kCartesian;
using testing::mend;
using testing::packed;
using testing::raw;
using testing::root_xml;
using testing::scalar_values;
using testing::scan_xml;
using testing::two_scans;

TEST(E57ReaderTest, ScansArePosedAndTheirBitsRunOnAcrossPackets) {
  const std::string file = two_scans();
  const Result<ScanStream> stream = ScanStream::open_content(testing::as_bytes(file), "stations.e57");
  ASSERT_TRUE(stream) << stream.error().message;
  EXPECT_EQ(stream->schema().crs, "EPSG:32632");
  const Result<testing::WholeScan> points = testing::whole(stream);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 42U);
  // x = 10 i / 2 + 1 and y = z = 100 / 2 + 1, turned about z by 90 degrees, moved.
  for (int i = 3; i < 40; ++i) {
    const glm::dvec3 expected(100.0 - 51, 200.0 + 5 * i + 1, 351);
    EXPECT_LT(glm::length(points->positions[static_cast<size_t>(i)] - expected), 1e-9) << i;
  }
  EXPECT_TRUE(std::isnan(points->positions[1].x)) << "a direction only";
  EXPECT_TRUE(std::isnan(points->positions[2].z)) << "invalid";
  EXPECT_LT(glm::length(points->positions[40] - glm::dvec3(0, 0, 2)), 1e-15);
  EXPECT_LT(glm::length(points->positions[41] - glm::dvec3(-3, 0, 0)), 1e-15);
}

TEST(E57ReaderTest, WhatOnlyOneScanHasIsGreyOrZeroInTheOthers) {
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(two_scans()), "stations.e57");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_TRUE(points->colors);
  EXPECT_EQ(points->colors->bits, 16);
  EXPECT_EQ(points->colors->values[39], glm::u16vec3(39000));
  EXPECT_EQ(points->colors->values[41], glm::u16vec3(32768));
  const auto rows = scalar_values<uint8_t>(*points, "row_index");
  ASSERT_EQ(rows.size(), 42U);
  EXPECT_EQ(rows[0], 7) << "of a field without bits the minimum";
  EXPECT_EQ(rows[41], 0);
}

std::string one_scan(const std::string& fields = kCartesian, size_t count = 2) {
  E57File file;
  const size_t section = file.add_points({{raw({1.0, 2.0}), raw({3.0, 4.0}), raw({5.0F, 6.0F})}});
  return file.text(root_xml(scan_xml(section, count, fields)));
}

TEST(E57ReaderTest, FloatsAreDoubleWithoutAPrecision) {
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(one_scan()), "one.e57");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 3, 5), glm::dvec3(2, 4, 6)));
}

std::string e57_error(const std::string& file) {
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(file), "one.e57");
  return points ? "" : points.error().message;
}

TEST(E57ReaderTest, WhatCannotBeReadIsNamed) {
  EXPECT_THAT(e57_error(one_scan(kCartesian, 3)), HasSubstr("states 3 points, its values are fewer"));
  EXPECT_THAT(e57_error(one_scan("<cartesianX type='Float'/>")), HasSubstr("no coordinates"));
  EXPECT_THAT(e57_error(one_scan("<cartesianX type='Word'/>")), HasSubstr("type that is not supported"));
  EXPECT_THAT(e57_error(one_scan("<cartesianX type='Integer' minimum='4' maximum='3'/>")),
              HasSubstr("above its maximum"));
  EXPECT_THAT(e57_error(one_scan(std::string(kCartesian) + "<intensity type='Float'/>")),
              HasSubstr("one stream for each"));
  EXPECT_THAT(e57_error(one_scan("<cartesianX type='Float'>")), HasSubstr("XML is damaged"));
  std::string nested;
  for (int i = 0; i < 100; ++i) nested += "<a>";
  EXPECT_THAT(e57_error(one_scan(nested)), HasSubstr("nested too deeply"));
  const std::string still = "type='Integer' minimum='1' maximum='1'/>";
  EXPECT_THAT(e57_error(one_scan("<cartesianX " + still + "<cartesianY " + still + "<cartesianZ " + still, 1000000000)),
              HasSubstr("all in one place"));
}

TEST(E57ReaderTest, AChangedByteIsAWrongChecksum) {
  const std::string good = one_scan();
  for (size_t at = 100; at < good.size(); at += 37) {
    std::string file = good;
    file[at] = static_cast<char>(file[at] ^ 4);
    // What no value needs is not read.
    const std::string error = e57_error(file);
    if (!error.empty()) {
      EXPECT_THAT(error, HasSubstr("one.e57: the checksum of E57 page"));
    }
  }
  std::string file = good;
  file[60] = static_cast<char>(file[60] ^ 1);
  EXPECT_THAT(e57_error(file), HasSubstr("the checksum of E57 page 0 is wrong"));
}

TEST(E57ReaderTest, EveryTruncationIsAnError) {
  const std::string whole = two_scans();
  for (size_t size = 8; size < whole.size(); size += 5) EXPECT_NE(e57_error(whole.substr(0, size)), "") << size;
}

TEST(E57ReaderTest, ChangedBytesWithRightChecksumsAreReadOrRefused) {
  const std::string good = two_scans();
  std::mt19937 random(9);
  int errors = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string file = good;
    for (auto flips = 1 + random() % 3; flips > 0; --flips) {
      const size_t at = random() % file.size();
      file[at] = static_cast<char>(file[at] ^ 1 << random() % 8);
      mend(file, at / E57File::kPage * E57File::kPage);
    }
    const std::string error = e57_error(file);
    errors += error.empty() ? 0 : 1;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  EXPECT_GT(errors, 200);
}

}  // namespace
}  // namespace surfcast::scan
