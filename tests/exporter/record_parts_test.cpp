#include "exporter/record_parts.h"

#include <algorithm>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/scratch_folder.h"
#include "octree_scans.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;

class RecordPartsTest : public ::testing::Test {
 protected:
  RecordPartsTest() {
    const std::string text = file_.text();
    const auto bytes = testing::as_bytes(text);
    head_.header.assign(bytes.begin(), bytes.begin() + 375);
    head_.point_format = 6;
    head_.record_length = file_.records[0].size();
    for (const std::string& record : file_.records) counts_.add(testing::as_bytes(record), head_);
  }

  RecordSpool spool(uint64_t memory) {
    RecordSpool spool(target(), head_.record_length, memory);
    for (const std::string& record : file_.records) EXPECT_TRUE(spool.append(testing::as_bytes(record)));
    return spool;
  }
  [[nodiscard]] fs::path target() const { return folder_->path() / "target"; }

  testing::LasFile file_ = hills(6, 3000);
  LasHead head_;
  LasCounts counts_;
  Result<ScratchFolder> folder_ = ScratchFolder::create(fs::temp_directory_path(), "parts-test-");
};

TEST_F(RecordPartsTest, WhatIsInMemoryIsOnePartInItsOrder) {
  const RecordPlaces places(head_, cube_of(head_, counts_));
  RecordParts parts(places, {10, 14});
  RecordSpool records = spool(1 << 20);
  ASSERT_TRUE(records.is_resident());
  ASSERT_TRUE(parts.divide(records, target()));
  ASSERT_EQ(parts.parts().size(), 1U);
  EXPECT_EQ(parts.parts()[0].count, 3000U);
  const auto bytes = parts.take(0);
  ASSERT_TRUE(bytes);
  std::string all;
  for (const std::string& record : file_.records) all += record;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()), all);
}

TEST_F(RecordPartsTest, PartsAreTheLargestCellsThatTheLimitAllows) {
  constexpr uint64_t kMax = 100;
  const RecordPlaces places(head_, cube_of(head_, counts_));
  RecordParts parts(places, {kMax, 14});
  RecordSpool records = spool(1 << 14);
  ASSERT_FALSE(records.is_resident());
  ASSERT_TRUE(parts.divide(records, target()));
  std::map<uint64_t, size_t> codes;  // how often
  for (const std::string& record : file_.records) ++codes[places.codes(testing::as_bytes(record))[0]];
  const auto count = [&](const ldc::OctreeKey& key) {
    size_t sum = 0;
    for (const auto& [code, times] : codes) sum += ldc::key_of_code(code, key.depth) == key ? times : 0;
    return sum;
  };
  std::vector<std::string> all;
  for (size_t i = 0; i < parts.parts().size(); ++i) {
    const RecordPart& part = parts.parts()[i];
    EXPECT_EQ(part.count, count(part.key));
    EXPECT_LE(part.count, kMax);
    EXPECT_GT(count(part.key.parent()), kMax);
    EXPECT_TRUE(i == 0 || parts.parts()[i - 1].first < part.first);
    const auto bytes = parts.take(i);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ(bytes->size(), part.count * head_.record_length);
    for (size_t at = 0; at < bytes->size(); at += head_.record_length) {
      all.emplace_back(reinterpret_cast<const char*>(&(*bytes)[at]), head_.record_length);
      EXPECT_EQ(ldc::key_of_code(places.codes(testing::as_bytes(all.back()))[0], part.key.depth), part.key);
    }
  }
  std::ranges::sort(all);
  std::ranges::sort(file_.records);
  EXPECT_EQ(all, file_.records);
  EXPECT_TRUE(fs::is_empty(folder_->path()));
}

TEST_F(RecordPartsTest, PlacesAreWithinTheirCells) {
  const RecordPlaces places(head_, cube_of(head_, counts_));
  for (const std::string& record : file_.records) {
    const uint64_t code = places.codes(testing::as_bytes(record))[0];
    for (const int depth : {0, 3, 9}) {
      const glm::vec3 place = places.place_in(ldc::key_of_code(code, depth), testing::as_bytes(record).data());
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(place[axis], -1e-6F);
        EXPECT_LE(place[axis], 1 + 1e-6F);
      }
    }
  }
}

}  // namespace
}  // namespace surfcast::exporter
