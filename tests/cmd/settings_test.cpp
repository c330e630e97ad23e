#include "cmd/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::cmd {
namespace {

using ::testing::HasSubstr;

TEST(SettingsTest, SizesKeepToTheirRange) {
  constexpr SettingRange kRange{1024, uint64_t{1} << 20};
  EXPECT_EQ(*parse_size("1K", kRange), 1024U);
  EXPECT_EQ(*parse_size("1M", kRange), uint64_t{1} << 20);
  EXPECT_THAT(parse_size("1023", kRange).error().message, HasSubstr("at least 1K: 1023"));
  EXPECT_THAT(parse_size("2M", kRange).error().message, HasSubstr("at most 1M: 2M"));
  EXPECT_EQ(*parse_size("0", {0, 1024}), 0U) << "for limits that may be none";
  for (const char* text : {"", "lots", "1.5M", "-1", "4GB", "0"}) {
    EXPECT_THAT(parse_size(text, kRange).error().message, HasSubstr("not a size like 4G or 512M")) << text;
  }
}

TEST(SettingsTest, CountsAreWholeNumbersOfTheirRange) {
  EXPECT_EQ(*parse_count("0", {0, 5}), 0U);
  EXPECT_EQ(*parse_count("5", {0, 5}), 5U);
  for (const char* text : {"", "6", "-1", "2.0", "3x", " 3", "99999999999999999999"}) {
    EXPECT_THAT(parse_count(text, {0, 5}).error().message, HasSubstr("from 0 to 5")) << text;
  }
}

TEST(SettingsTest, SecondsMayHaveAFraction) {
  EXPECT_EQ(parse_seconds("2.5")->count(), 2500);
  EXPECT_EQ(parse_seconds("0.001")->count(), 1);
  EXPECT_EQ(parse_seconds("864000")->count(), 864'000'000);
  for (const char* text : {"", "0", "-1", "nan", "inf", "1e9", "5s"}) EXPECT_FALSE(parse_seconds(text)) << text;
}

TEST(SettingsTest, SizesAreWrittenForPeople) {
  EXPECT_EQ(size_text(0), "0");
  EXPECT_EQ(size_text(1023), "1023");
  EXPECT_EQ(size_text(uint64_t{1} << 20), "1M");
  EXPECT_EQ(size_text(uint64_t{3} << 29), "1.5G");
  EXPECT_EQ(size_text(uint64_t{2} << 40), "2048G");
}

}  // namespace
}  // namespace surfcast::cmd
