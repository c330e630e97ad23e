#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/las_reader.h"
#include "scan/scan_stream.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using ::testing::HasSubstr;

std::filesystem::path data_file(const std::string& name) {
  return std::filesystem::path(SURFCAST_TEST_DATA) / "laz" / name;
}

std::string content_of(const std::string& name) {
  std::ifstream in(data_file(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// FNV-1a of all point records. The expected values are those of records that another decoder gave.
uint64_t records_digest(const std::string& name) {
  const std::string content = content_of(name);
  const Result<std::unique_ptr<RowSource>> rows = las_rows(testing::as_bytes(content));
  if (!rows) return 0;
  uint64_t digest = 14695981039346656037U;
  for (size_t piece = 0; piece < (*rows)->pieces(); ++piece) {
    const Result<PointTable> table = (*rows)->read(piece);
    if (!table) return 0;
    for (const std::byte byte : table->records) digest = (digest ^ std::to_integer<uint64_t>(byte)) * 1099511628211U;
  }
  return digest;
}

TEST(LazReaderTest, RecordsOfOtherCodersAreDecodedToTheLastByte) {
  EXPECT_EQ(records_digest("indoor.laz"), 0x310F18EFBB8DA68BU);
  EXPECT_EQ(records_digest("lion.laz"), 0x02CC02DB9FAB9952U);
  EXPECT_EQ(records_digest("random-rgb-nir.laz"), 0xD8D0590F9107BE12U);
}

TEST(LazReaderTest, CompressedFilesAreScansLikeAnyOther) {
  const Result<testing::WholeScan> lion = testing::whole(ScanStream::open(data_file("lion.laz")));
  ASSERT_TRUE(lion) << lion.error().message;
  EXPECT_EQ(lion->positions.size(), 300U);
  ASSERT_TRUE(lion->colors);
  EXPECT_EQ(lion->colors->values.size(), 300U);
  EXPECT_EQ(testing::scalar_values<uint16_t>(*lion, "intensity").size(), 300U);
}

TEST(LazReaderTest, EveryTruncationOfAFileIsOneLineThatNamesIt) {
  const std::string whole = content_of("indoor.laz");
  for (size_t size = 0; size + 4 < whole.size(); size += 7) {
    const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(whole.substr(0, size)), "scan.laz");
    ASSERT_FALSE(points) << size;
    ASSERT_THAT(points.error().message, HasSubstr("scan.laz: "));
    ASSERT_EQ(points.error().message.find('\n'), std::string::npos);
  }
}

TEST(LazReaderTest, FilesWithChangedBytesAreReadOrRefused) {
  std::mt19937 random(11);
  for (const char* name : {"indoor.laz", "lion.laz", "random-rgb-nir.laz"}) {
    const std::string whole = content_of(name);
    for (int i = 0; i < 300; ++i) {
      std::string damaged = whole;
      const size_t at = i % 3 == 0 ? random() % 500 : random() % damaged.size();
      damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
      const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(damaged), "scan.laz");
      ASSERT_LE(points ? points->positions.size() : 0, 1000U);
    }
  }
}

TEST(LazReaderTest, ACompressedFileWithoutTheRecordOfLaszipIsRefused) {
  std::string content = content_of("indoor.laz");
  content[content.find("laszip encoded")] = 'L';
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(content), "scan.laz");
  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("without a LASzip record"));
}

}  // namespace
}  // namespace surfcast::scan
