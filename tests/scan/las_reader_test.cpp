#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/las_file.h"
#include "scan/las_header.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::LasFile;
using testing::scalar_values;

Result<testing::WholeScan> read(const LasFile& file) {
  return testing::read_whole(as_bytes(file.text()), "scan.las");
}

std::vector<std::string> scalar_names(const ScanPoints& points) {
  std::vector<std::string> names;
  for (const surfel::ScalarAttribute& scalar : points.scalars) names.push_back(scalar.name);
  return names;
}

TEST(LasReaderTest, CoordinatesAreIndexTimesScalePlusOffsetToTheLastBit) {
  LasFile file;
  const double scale[3] = {1e-7, 0.001, 0.01};
  const double offset[3] = {-94.7, 5e6, 0.1};
  std::copy_n(scale, 3, file.scale);
  std::copy_n(offset, 3, file.offset);
  constexpr int32_t kMin = std::numeric_limits<int32_t>::min();
  constexpr int32_t kMax = std::numeric_limits<int32_t>::max();
  file.records = {file.record(kMin, -1, 3).text(), file.record(kMax, 7, kMin).text()};
  const Result<testing::WholeScan> points = read(file);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->positions[0].x, kMin * scale[0] + offset[0]);
  EXPECT_EQ(points->positions[0].y, -1 * scale[1] + offset[1]);
  EXPECT_EQ(points->positions[1].z, kMin * scale[2] + offset[2]);
  ASSERT_TRUE(points->grid);
  EXPECT_EQ(points->grid->index(points->positions[1]), glm::i64vec3(kMax, 7, kMin));
  EXPECT_EQ(points->grid->position({kMax, 7, kMin}), points->positions[1]);
  EXPECT_TRUE(points->z_up);
}

/// Every point format of every version that may have it, with all fields of the format set.
class LasFormatTest : public ::testing::TestWithParam<int> {};

TEST_P(LasFormatTest, ReadsEveryFieldOfTheFormat) {
  LasFile file;
  file.format = GetParam();
  file.minor = file.format < 4 ? 2 : file.format < 6 ? 3 : 4;
  const bool legacy = file.format < 6;
  testing::Bytes record = file.record(1, 2, 3);
  record.set<uint16_t>(12, 40000);
  if (legacy) {
    // Return 2 of 5, scan direction, edge; class 18, synthetic; angle -15; user 7; source 300.
    record.set<uint8_t>(14, 2 | 5 << 3 | 1 << 6 | 1 << 7).set<uint8_t>(15, 18 | 1 << 5);
    record.set<int8_t>(16, -15).set<uint8_t>(17, 7).set<uint16_t>(18, 300);
  } else {
    record.set<uint8_t>(14, 2 | 5 << 4).set<uint8_t>(15, 1 | 3 << 4 | 1 << 6 | 1 << 7).set<uint8_t>(16, 64);
    record.set<uint8_t>(17, 7).set<int16_t>(18, -2500).set<uint16_t>(20, 300);
  }
  const bool has_time = file.format != 0 && file.format != 2;
  const int time_offset = legacy ? 20 : 22;
  if (has_time) record.set<double>(static_cast<size_t>(time_offset), 123456.789);
  const int color_offsets[] = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  const auto color = static_cast<size_t>(color_offsets[file.format]);
  if (color != 0) record.set<uint16_t>(color, 65535).set<uint16_t>(color + 2, 256).set<uint16_t>(color + 4, 1);
  const bool has_nir = file.format == 8 || file.format == 10;
  if (has_nir) record.set<uint16_t>(36, 5000);
  const size_t wave_offsets[] = {0, 0, 0, 0, 28, 34, 0, 0, 0, 30, 38};
  const size_t wave = wave_offsets[file.format];
  if (wave != 0) {
    record.set<uint8_t>(wave, 3).set<uint64_t>(wave + 1, uint64_t{1} << 40).set<uint32_t>(wave + 9, 512);
    record.set<float>(wave + 13, 1.5F).set<float>(wave + 17, 2).set<float>(wave + 21, -3).set<float>(wave + 25, 4);
  }
  file.records = {record.text()};

  const Result<testing::WholeScan> points = read(file);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(scalar_values<uint8_t>(*points, "wave_packet_index").size(), wave != 0 ? 1U : 0U);
  EXPECT_THAT(scalar_values<uint8_t>(*points, "wave_packet_index"), Each(3));
  EXPECT_THAT(scalar_values<uint64_t>(*points, "wave_packet_offset"), Each(uint64_t{1} << 40));
  EXPECT_THAT(scalar_values<uint32_t>(*points, "wave_packet_size"), Each(512));
  EXPECT_THAT(scalar_values<float>(*points, "wave_return_location"), Each(1.5F));
  EXPECT_THAT(scalar_values<float>(*points, "wave_dx"), Each(2));
  EXPECT_THAT(scalar_values<float>(*points, "wave_dy"), Each(-3));
  EXPECT_THAT(scalar_values<float>(*points, "wave_dz"), Each(4));
  EXPECT_THAT(scalar_values<uint16_t>(*points, "intensity"), ElementsAre(40000));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "return_number"), ElementsAre(2));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "number_of_returns"), ElementsAre(5));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "classification"), ElementsAre(legacy ? 18 : 64));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "classification_flags"), ElementsAre(1));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "scan_direction_flag"), ElementsAre(1));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "edge_of_flight_line"), ElementsAre(1));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "user_data"), ElementsAre(7));
  EXPECT_THAT(scalar_values<uint16_t>(*points, "point_source_id"), ElementsAre(300));
  if (legacy) {
    EXPECT_THAT(scalar_values<int8_t>(*points, "scan_angle_rank"), ElementsAre(-15));
  } else {
    EXPECT_THAT(scalar_values<int16_t>(*points, "scan_angle"), ElementsAre(-2500));
    EXPECT_THAT(scalar_values<uint8_t>(*points, "scanner_channel"), ElementsAre(3));
  }
  EXPECT_EQ(scalar_values<double>(*points, "gps_time").size(), has_time ? 1U : 0U);
  EXPECT_THAT(scalar_values<double>(*points, "gps_time"), Each(123456.789));
  EXPECT_EQ(points->colors.has_value(), color != 0);
  if (points->colors) {
    EXPECT_THAT(points->colors->values, ElementsAre(glm::u16vec3(65535, 256, 1)));
  }
  EXPECT_EQ(scalar_values<uint16_t>(*points, "nir").size(), has_nir ? 1U : 0U);
}

INSTANTIATE_TEST_SUITE_P(AllFormats, LasFormatTest, ::testing::Range(0, 11));

TEST(LasReaderTest, AllVersionsAreRead) {
  for (int minor = 0; minor <= 5; ++minor) {
    LasFile file;
    file.minor = minor;
    file.records = {file.record(100, 200, 300).text()};
    const Result<testing::WholeScan> points = read(file);
    ASSERT_TRUE(points) << minor << points.error().message;
    EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 2, 3)));
  }
}

LasFile colored(std::vector<uint16_t> reds) {
  LasFile file;
  file.format = 2;
  for (const uint16_t red : reds) file.records.push_back(file.record(1, 2, 3).set<uint16_t>(20, red).text());
  return file;
}

TEST(LasReaderTest, ColoursUpTo255AreEightBit) {
  const Result<testing::WholeScan> points = read(colored({0, 255}));
  ASSERT_TRUE(points && points->colors);
  EXPECT_EQ(points->colors->bits, 8);
  EXPECT_THAT(points->colors->values, ElementsAre(glm::u16vec3(0), glm::u16vec3(255, 0, 0)));
}

TEST(LasReaderTest, ColoursAbove255AreSixteenBit) {
  const Result<testing::WholeScan> points = read(colored({1, 256}));
  ASSERT_TRUE(points && points->colors);
  EXPECT_EQ(points->colors->bits, 16);
  EXPECT_THAT(points->colors->values, ElementsAre(glm::u16vec3(1, 0, 0), glm::u16vec3(256, 0, 0)));
}

TEST(LasReaderTest, FieldsThatAreZeroEverywhereAreNotAttributes) {
  const Result<testing::WholeScan> points = read(colored({0, 0}));
  ASSERT_TRUE(points);
  EXPECT_FALSE(points->colors);
  EXPECT_THAT(points->scalars, ::testing::IsEmpty());
}

/// One entry of the record that declares extra bytes.
std::string extra_entry(uint8_t type, uint8_t options, const std::string& name, double scale = 0, double shift = 0) {
  testing::Bytes entry(std::string(192, '\0'));
  entry.set<uint8_t>(2, type).set<uint8_t>(3, options);
  for (size_t i = 0; i < name.size(); ++i) entry.set<char>(4 + i, name[i]);
  return entry.set<double>(112, scale).set<double>(136, shift).text();
}

std::string variable_record(const std::string& user, uint16_t id, const std::string& body) {
  testing::Bytes record(std::string(54, '\0'));
  for (size_t i = 0; i < user.size(); ++i) record.set<char>(2 + i, user[i]);
  record.set<uint16_t>(18, id).set<uint16_t>(20, static_cast<uint16_t>(body.size()));
  return record.text() + body;
}

TEST(LasReaderTest, ExtraBytesBecomeAttributesOfTheirTypeScaledWhereStated) {
  LasFile file;
  file.minor = 4;
  file.format = 6;
  file.extra_bytes = 4 + 3 + 2 + 4;
  file.variable_record_count = 2;
  file.variable_records =
      variable_record("other", 4, "abc") +
      variable_record("LASF_Spec", 4,
                      extra_entry(9, 0, "range") + extra_entry(0, 3, "undocumented") +
                          extra_entry(4, 8 | 16, "height", 0.5, 100) + extra_entry(5, 0, "intensity"));
  testing::Bytes record = file.record(1, 1, 1);
  record.set<uint16_t>(12, 9).set<float>(30, 2.5F).set<int16_t>(37, -3).set<uint32_t>(39, 77);
  file.records = {record.text()};
  const Result<testing::WholeScan> points = read(file);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(scalar_names(*points), ElementsAre("intensity", "range", "height", "intensity_2"));
  EXPECT_THAT(scalar_values<float>(*points, "range"), ElementsAre(2.5F));
  EXPECT_THAT(scalar_values<double>(*points, "height"), ElementsAre(98.5));
  EXPECT_THAT(scalar_values<uint32_t>(*points, "intensity_2"), ElementsAre(77U));
}

TEST(LasReaderTest, WrongNumberOfVariableRecordsDoesNotHideThePoints) {
  LasFile file;
  file.variable_records = variable_record("someone", 1, "text");
  file.variable_record_count = 4000000000U;
  file.records = {file.record(100, 200, 300).text()};
  const Result<testing::WholeScan> points = read(file);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 2, 3)));
}

/// A record behind the points (LAS 1.4 R15, 2.7).
std::string extended_record(const std::string& user, uint16_t id, const std::string& body) {
  testing::Bytes record(std::string(60, '\0'));
  for (size_t i = 0; i < user.size(); ++i) record.set(2 + i, user[i]);
  return record.set(18, id).set<uint64_t>(20, body.size()).text() + body;
}

TEST(LasReaderTest, ASystemInARecordBehindThePointsIsRead) {
  LasFile file;
  file.minor = 4;
  file.format = 6;
  file.records = {file.record(1, 2, 3).text()};
  const std::string text = file.text();
  testing::Bytes bytes(text + extended_record("someone", 2112, "no system") +
                       extended_record("LASF_Projection", 2112, "PROJCRS[\"a\"]"));
  bytes.set<uint64_t>(235, text.size()).set<uint32_t>(243, 2);
  const Result<LasHeader> header = parse_las_header(bytes.bytes());
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->crs, "PROJCRS[\"a\"]");
  bytes.set<uint64_t>(235, text.size() + 1'000'000);
  EXPECT_EQ(parse_las_header(bytes.bytes())->crs, "") << "beyond the end of the file";
}

/// A GeoKey directory of these keys.
std::string geo_keys(const std::vector<std::pair<uint16_t, uint16_t>>& keys) {
  testing::Bytes body;
  body.add<uint16_t>(1).add<uint16_t>(1).add<uint16_t>(0).add(static_cast<uint16_t>(keys.size()));
  for (const auto& [key, value] : keys) body.add(key).add<uint16_t>(0).add<uint16_t>(1).add(value);
  return body.text();
}

TEST(LasReaderTest, UnitsAndHeightsOfGeoKeysAreStated) {
  const auto system_of = [](const std::vector<std::pair<uint16_t, uint16_t>>& keys) {
    LasFile file;
    file.variable_records = variable_record("LASF_Projection", 34735, geo_keys(keys));
    file.variable_record_count = 1;
    file.records = {file.record(1, 2, 3).text()};
    return parse_las_header(as_bytes(file.text()))->crs;
  };
  EXPECT_EQ(system_of({{1024, 1}, {3072, 26918}}), "EPSG:26918");
  EXPECT_EQ(system_of({{3072, 26918}, {3076, 9003}}), "EPSG:26918@9003");
  EXPECT_EQ(system_of({{3072, 26918}, {4096, 5703}, {4099, 9002}}), "EPSG:26918+5703@9002");
  EXPECT_EQ(system_of({{3072, 26918}, {4096, 6360}}), "EPSG:26918+6360@0");
  EXPECT_EQ(system_of({{3072, 26918}, {3076, 9002}, {4099, 9001}}), "EPSG:26918@9002+0@9001");
  EXPECT_EQ(system_of({{2048, 4326}, {3076, 9002}, {4099, 9002}}), "EPSG:4326") << "degrees have no unit of length";
  EXPECT_EQ(system_of({{3072, 32767}, {3076, 9002}}), "") << "defined elsewhere";
}

/// The reader's answer to a good file of two points with one number changed.
template <typename T>
std::string message_with(size_t offset, T value, int minor = 2) {
  LasFile file;
  file.minor = minor;
  file.records = {file.record(1, 2, 3).text(), file.record(4, 5, 6).text()};
  const Result<testing::WholeScan> points =
      testing::read_whole(testing::Bytes(file.text()).set(offset, value).bytes(), "scan.las");
  return points ? "" : points.error().message;
}

TEST(LasReaderTest, BadHeadersAreNamed) {
  EXPECT_THAT(message_with<uint8_t>(24, 2), HasSubstr("version 2.2"));
  EXPECT_THAT(message_with<uint8_t>(25, 6), HasSubstr("version 1.6"));
  EXPECT_THAT(message_with<uint16_t>(94, 226), HasSubstr("header size"));
  EXPECT_THAT(message_with<uint16_t>(94, 60000), HasSubstr("truncated"));
  EXPECT_THAT(message_with<uint32_t>(96, 100), HasSubstr("begin in the header"));
  EXPECT_THAT(message_with<uint32_t>(96, 4000000000U), HasSubstr("beyond the end"));
  EXPECT_THAT(message_with<uint8_t>(104, 11), HasSubstr("format 11"));
  EXPECT_THAT(message_with<uint8_t>(104, 128), HasSubstr("LAZ compressed"));
  EXPECT_THAT(message_with<uint8_t>(104, 1), HasSubstr("too short"));
  EXPECT_THAT(message_with<uint16_t>(105, 0), HasSubstr("too short"));
  EXPECT_THAT(message_with<uint32_t>(107, 3), HasSubstr("truncated: the header states 3 points"));
  EXPECT_THAT(message_with<uint32_t>(107, 0), HasSubstr("no points"));
  EXPECT_THAT(message_with<uint64_t>(247, ~uint64_t{0}, 4), HasSubstr("truncated"));
  EXPECT_THAT(message_with<double>(131, 0.0), HasSubstr("scale"));
  EXPECT_THAT(message_with<double>(163, std::numeric_limits<double>::quiet_NaN()), HasSubstr("offset"));
}

}  // namespace
}  // namespace surfcast::scan
