#include "exporter/las14.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporter/las_bytes.h"
#include "laz/sample_records.h"
#include "scan/las_file.h"
#include "scan/las_reader.h"

namespace surfcast::exporter {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The value of a field of a record, as a number.
double value_of(const std::byte* record, const scan::LasField& field) {
  if (field.mask != 0) return std::to_integer<int>(record[field.offset]) >> field.shift & field.mask;
  return scan::with_type(
      field.type, [&](auto zero) { return static_cast<double>(scan::load<decltype(zero)>(record + field.offset)); });
}

class Las14FormatTest : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OldFormats, Las14FormatTest, ::testing::Range(0, 4));

TEST_P(Las14FormatTest, EveryFieldOfARecordKeepsItsValue) {
  constexpr size_t kExtra = 5;
  const int modern = modern_point_format(GetParam());
  EXPECT_EQ(modern, GetParam() < 2 ? 6 : 7);
  const auto core = static_cast<size_t>(testing::las_record_bytes(GetParam()));
  const auto modern_core = static_cast<size_t>(testing::las_record_bytes(modern));
  const std::vector<std::byte> old = laz::testing::sample_records(core + kExtra, 500);
  const std::vector<std::byte> records = modern_records(old, GetParam(), core + kExtra);
  ASSERT_EQ(records.size(), 500 * (modern_core + kExtra));
  for (size_t i = 0; i < 500; ++i) {
    const std::byte *from = &old[i * (core + kExtra)], *to = &records[i * (modern_core + kExtra)];
    EXPECT_TRUE(std::equal(from, from + 12, to));
    EXPECT_TRUE(std::equal(from + core, from + core + kExtra, to + modern_core));
    for (const scan::LasField& field : scan::las_fields(GetParam())) {
      for (const scan::LasField& now : scan::las_fields(modern)) {
        if (now.name != std::string_view(field.name)) continue;
        const double found = value_of(to, now), expected = value_of(from, field);
        EXPECT_TRUE(found == expected || (std::isnan(found) && std::isnan(expected))) << field.name;
      }
    }
    EXPECT_NEAR(scan::load<int16_t>(to + 18) * 0.006, scan::load<int8_t>(from + 16), 0.003);
    EXPECT_TRUE(GetParam() % 2 == 1 || scan::load<double>(to + 22) == 0);
  }
}

TEST(Las14Test, NewRecordsStayAsTheyAre) {
  const std::vector<std::byte> records = laz::testing::sample_records(38, 10);
  EXPECT_EQ(modern_records(records, 8, 38), records);
}

LasHead old_head(int format) {
  testing::LasFile file;
  file.format = format;
  const std::string text = file.text();
  LasHead head;
  const auto bytes = testing::as_bytes(text);
  head.header.assign(bytes.begin(), bytes.end());
  head.point_format = format;
  head.record_length = static_cast<size_t>(testing::las_record_bytes(format)) + 3;
  return head;
}

TEST(Las14Test, GeoKeysBecomeWkt) {
  LasHead head = old_head(3);
  head.records.push_back(las_record("LASF_Projection", 34735, std::vector<std::byte>(16)));
  head.records.push_back(las_record("somebody", 34735, std::vector<std::byte>(2)));
  EXPECT_THAT(become_version_14(head, "EPSG:25832"), IsEmpty());
  EXPECT_EQ(head.point_format, 7);
  EXPECT_EQ(head.record_length, 36U + 3);
  ASSERT_EQ(head.header.size(), 375U);
  EXPECT_EQ(scan::load<uint8_t>(&head.header[25]), 4);
  EXPECT_EQ(scan::load<uint16_t>(&head.header[94]), 375);
  EXPECT_EQ(scan::load<uint16_t>(&head.header[6]) & 16, 16);
  EXPECT_EQ(scan::load<double>(&head.header[131]), 0.01);
  ASSERT_EQ(head.records.size(), 2U);
  EXPECT_EQ(scan::load<uint16_t>(&head.records[1][18]), 2112);
  const std::string wkt(reinterpret_cast<const char*>(&head.records[1][54]), head.records[1].size() - 54);
  EXPECT_THAT(wkt, HasSubstr("25832"));
  EXPECT_EQ(wkt.back(), '\0');
}

TEST(Las14Test, TheTimeOffsetOfVersion15IsSaid) {
  testing::LasFile file;
  file.minor = 5;
  file.format = 6;
  const std::string text = file.text();
  LasHead head;
  const auto bytes = testing::as_bytes(text);
  head.header.assign(bytes.begin(), bytes.end());
  head.point_format = 6;
  head.record_length = 30;
  put(head.header, 6, uint16_t{64 | 1});
  put(head.header, 391, uint16_t{1300});
  EXPECT_THAT(become_version_14(head, ""), ::testing::ElementsAre(HasSubstr("1300 million seconds")));
  EXPECT_EQ(head.header.size(), 375U);
  EXPECT_EQ(scan::load<uint8_t>(&head.header[25]), 4);
  EXPECT_EQ(scan::load<uint16_t>(&head.header[6]), 16 | 1);
}

TEST(Las14Test, WktStaysAsItIs) {
  LasHead head = old_head(1);
  const std::vector<std::byte> record = las_record("LASF_Projection", 2112, std::vector<std::byte>(9));
  head.records.push_back(record);
  EXPECT_THAT(become_version_14(head, "LOCAL_CS[\"here\"]"), IsEmpty());
  EXPECT_THAT(head.records, ::testing::ElementsAre(record));
  EXPECT_EQ(scan::load<uint16_t>(&head.header[6]) & 16, 16);
}

TEST(Las14Test, ASystemThatNothingKnowsIsKeptAndSaid) {
  LasHead head = old_head(0);
  const std::vector<std::byte> record = las_record("LASF_Projection", 34735, std::vector<std::byte>(16));
  head.records.push_back(record);
  EXPECT_THAT(become_version_14(head, "EPSG:65000"), ::testing::ElementsAre(HasSubstr("EPSG:65000")));
  EXPECT_THAT(head.records, ::testing::ElementsAre(record));
  EXPECT_EQ(scan::load<uint16_t>(&head.header[6]) & 16, 0);
}

}  // namespace
}  // namespace surfcast::exporter
