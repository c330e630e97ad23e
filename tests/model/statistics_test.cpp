#include "model/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "model/format.h"
#include "model/model_file.h"

namespace surfcast::model {
namespace {

surfel::SurfelCloud with_scalars(std::vector<surfel::ScalarAttribute> scalars) {
  surfel::SurfelCloud cloud;
  cloud.scalars = std::move(scalars);
  return cloud;
}

AttributeStatistics all_of(const surfel::SurfelCloud& cloud) {
  std::vector<uint32_t> members(surfel::value_count(cloud.scalars[0].values));
  std::iota(members.begin(), members.end(), 0);
  return {cloud, members};
}

const std::vector<std::string> kNames{"intensity", "classification", "time"};

surfel::SurfelCloud survey() {
  std::vector<uint16_t> intensities;
  std::vector<uint8_t> classes;
  std::vector<double> times;
  for (int i = 0; i < 10000; ++i) {
    intensities.push_back(static_cast<uint16_t>(i < 9999 ? i : 65535));
    classes.push_back(i < 7000 ? 2 : 200);
    times.push_back(-1.5 * i);
  }
  return with_scalars({{"intensity", intensities}, {"classification", classes}, {"time", times}});
}

TEST(Statistics, RangesAndCountsAreThoseOfTheValues) {
  const AttributeStatistics statistics = all_of(survey());
  const std::vector<AttributeRange> ranges = statistics.ranges(kNames);
  ASSERT_EQ(ranges.size(), 3u);
  EXPECT_EQ(ranges[0].smallest, 0);
  EXPECT_EQ(ranges[0].largest, 65535);
  EXPECT_NEAR(ranges[0].low, 200, 2);
  EXPECT_NEAR(ranges[0].high, 9800, 98) << "one bright reflector does not set it";
  EXPECT_EQ(ranges[2].smallest, -1.5 * 9999);
  EXPECT_EQ(ranges[2].low, ranges[2].smallest);
  const std::vector<ClassCount> classes = statistics.classes();
  ASSERT_EQ(classes.size(), 2u);
  EXPECT_EQ(classes[0].code, 2u);
  EXPECT_EQ(classes[0].surfels, 7000u);
  EXPECT_EQ(classes[1].code, 200u);
}

TEST(Statistics, WhatIsWrittenComesBack) {
  const AttributeStatistics statistics = all_of(survey());
  ByteWriter bytes;
  statistics.write(bytes);
  ByteReader reader(bytes.bytes());
  const AttributeStatistics read = AttributeStatistics::read(reader);
  EXPECT_TRUE(reader.ok() && reader.rest().empty());
  ASSERT_EQ(read.ranges(kNames).size(), 3u);
  for (size_t i = 0; i < kNames.size(); ++i) {
    const AttributeRange expected = statistics.ranges(kNames)[i];
    const AttributeRange range = read.ranges(kNames)[i];
    EXPECT_EQ(range.smallest, expected.smallest);
    EXPECT_EQ(range.largest, expected.largest);
    EXPECT_EQ(range.low, expected.low);
    EXPECT_EQ(range.high, expected.high);
  }
  ASSERT_EQ(read.classes().size(), 2u);
  EXPECT_EQ(read.classes()[1].surfels, 3000u);
  for (size_t size = 0; size < bytes.bytes().size(); ++size) {
    ByteReader cut(bytes.bytes().first(size));
    AttributeStatistics::read(cut);
    EXPECT_FALSE(cut.ok()) << size;
  }
}

TEST(Statistics, TheOrderOfBlocksDoesNotMatter) {
  const surfel::SurfelCloud cloud = survey();
  std::vector<uint32_t> odd;
  std::vector<uint32_t> even;
  for (uint32_t i = 0; i < 10000; ++i) (i % 2 == 0 ? even : odd).push_back(i);
  AttributeStatistics a(cloud, odd);
  a.add({cloud, even});
  AttributeStatistics b(cloud, even);
  b.add({cloud, odd});
  b.add({});
  const AttributeStatistics whole = all_of(cloud);
  for (const AttributeStatistics& sum : {a, b}) {
    EXPECT_EQ(sum.ranges(kNames)[0].high, whole.ranges(kNames)[0].high);
    EXPECT_EQ(sum.ranges(kNames)[0].low, whole.ranges(kNames)[0].low);
    EXPECT_EQ(sum.classes()[0].surfels, 7000u);
  }
}

TEST(Statistics, WhatIsNoNumberIsLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const surfel::SurfelCloud cloud = with_scalars({{"intensity", std::vector<float>{nan, -2, INFINITY, 5}},
                                                  {"classification", std::vector<float>{nan, nan, 3, 999}},
                                                  {"time", std::vector<float>(4, nan)}});
  const AttributeStatistics statistics = all_of(cloud);
  const std::vector<AttributeRange> ranges = statistics.ranges(kNames);
  ASSERT_EQ(ranges.size(), 2u);
  EXPECT_EQ(ranges[0].smallest, -2);
  EXPECT_EQ(ranges[0].largest, 5);
  EXPECT_LE(ranges[0].smallest, ranges[0].low);
  EXPECT_LE(ranges[0].low, ranges[0].high);
  EXPECT_LE(ranges[0].high, ranges[0].largest);
  ASSERT_EQ(statistics.classes().size(), 2u);
  EXPECT_EQ(statistics.classes()[1].code, 255u) << "codes are bytes";
}

TEST(Statistics, OneValueIsItsOwnRange) {
  const AttributeStatistics statistics = all_of(with_scalars({{"intensity", std::vector<int32_t>{-70000}}}));
  const AttributeRange range = statistics.ranges(kNames)[0];
  EXPECT_EQ(range.low, -70000);
  EXPECT_EQ(range.high, -70000);
  EXPECT_TRUE(statistics.classes().empty());
}

Directory tables() {
  Directory directory;
  directory.scalars = {{"intensity", 2, true}, {"time", 9, false}};
  directory.grids = {surfel::Grid{}};
  BlockRecord block;
  block.items = 1;
  block.spacing = block.max_radius = 1;
  block.offset = kHeaderBytes;
  directory.blocks = {block};
  directory.ranges = {{"intensity", 1, 9, 2, 8}};
  directory.classes = {{2, 5}, {6, 7}};
  return directory;
}

Result<Directory> reread_tables(const Directory& directory, size_t left_out = 0) {
  std::vector<std::byte> bytes = write_directory(directory);
  bytes.resize(bytes.size() - left_out);
  ModelHeader header;
  header.directory_offset = kHeaderBytes;
  header.directory_checksum = checksum_of(bytes);
  return read_directory(bytes, header);
}

TEST(StatisticsInFiles, ComeBack) {
  const Result<Directory> read = reread_tables(tables());
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->ranges.size(), 1u);
  EXPECT_EQ(read->ranges[0].attribute, "intensity");
  EXPECT_EQ(read->ranges[0].high, 8);
  ASSERT_EQ(read->classes.size(), 2u);
  EXPECT_EQ(read->classes[1].surfels, 7u);
}

TEST(StatisticsInFiles, AFileMayEndWithoutThemButNotWithin) {
  const size_t all = write_directory(tables()).size();
  Directory without = tables();
  without.ranges.clear();
  without.classes.clear();
  const size_t statistics = all - write_directory(without).size() + 8;
  for (size_t left_out = 1; left_out < statistics; ++left_out) {
    EXPECT_FALSE(reread_tables(tables(), left_out)) << left_out;
  }
  const Result<Directory> old = reread_tables(tables(), statistics);
  ASSERT_TRUE(old) << old.error().message;
  EXPECT_TRUE(old->ranges.empty() && old->classes.empty());
}

TEST(StatisticsInFiles, HostileOnesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto spoil) {
    Directory directory = tables();
    spoil(directory);
    return !reread_tables(directory);
  };
  EXPECT_TRUE(refused([](Directory& d) { d.ranges[0].attribute = "other"; }));
  EXPECT_TRUE(refused([](Directory& d) { d.ranges[0].smallest = 3; }));
  EXPECT_TRUE(refused([](Directory& d) { d.ranges[0].low = 8.5; }));
  EXPECT_TRUE(refused([](Directory& d) { d.ranges[0].largest = 7; }));
  EXPECT_TRUE(refused([&](Directory& d) { d.ranges[0].smallest = nan; }));
  EXPECT_TRUE(refused([&](Directory& d) { d.ranges[0].low = nan; }));
  EXPECT_TRUE(refused([](Directory& d) { d.ranges[0].largest = INFINITY; }));
  EXPECT_TRUE(refused([](Directory& d) { d.ranges.resize(3, d.ranges[0]); }));
  EXPECT_TRUE(refused([](Directory& d) { d.classes[1].code = 256; }));
  EXPECT_TRUE(refused([](Directory& d) { std::swap(d.classes[0], d.classes[1]); }));
  EXPECT_TRUE(refused([](Directory& d) { d.classes[1].code = 2; }));
}

}  // namespace
}  // namespace surfcast::model
