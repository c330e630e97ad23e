#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "laz/byte_access.h"
#include "laz/laz_writer.h"
#include "scan/bytes.h"
#include "scan/las_file.h"
#include "scan/las_reader.h"
#include "scan/scan_stream.h"
#include "scan/whole_scan.h"
#include "support/file_content.h"
#include "support/path_of.h"

namespace surfcast::scan {
namespace {

using ::testing::HasSubstr;

std::filesystem::path data_file(const std::string& name) {
  return std::filesystem::path(path_of("tests/data")) / "laz" / name;
}

/// FNV-1a of all point records. The expected values are those of records that another decoder gave.
uint64_t records_digest(const std::string& name) {
  const std::string content = testing::file_content(data_file(name));
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
  const std::string whole = testing::file_content(data_file("indoor.laz"));
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
    const std::string whole = testing::file_content(data_file(name));
    for (int i = 0; i < 300; ++i) {
      std::string damaged = whole;
      const size_t at = i % 3 == 0 ? random() % 500 : random() % damaged.size();
      damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
      const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(damaged), "scan.laz");
      ASSERT_LE(points ? points->positions.size() : 0, 1000U);
    }
  }
}

/// A file with one chunk for all points.
std::string one_chunk(size_t points) {
  laz::testing::LazWriter writer;
  writer.chunk_size = 0xFFFFFFFE;
  std::vector<std::byte> records(writer.record_length * points);
  for (size_t i = 0; i < points; ++i) laz::store(&records[i * writer.record_length], static_cast<int32_t>(i));
  const std::vector<std::byte> record = writer.laszip_record();
  testing::LasFile file;
  file.variable_record_count = 1;
  testing::Bytes head(std::string(54, '\0'));
  head.set(18, uint16_t{22204}).set(20, static_cast<uint16_t>(record.size()));
  std::string text = head.text();
  text.replace(2, 14, "laszip encoded");
  file.variable_records = text + std::string(reinterpret_cast<const char*>(record.data()), record.size());
  std::string whole = file.text();
  const std::vector<std::byte> data = writer.point_data(records, whole.size());
  whole[104] = static_cast<char>(0x80);
  laz::store(reinterpret_cast<std::byte*>(&whole[107]), static_cast<uint32_t>(points));
  return whole + std::string(reinterpret_cast<const char*>(data.data()), data.size());
}

TEST(LazReaderTest, ALargeChunkIsReadInSlicesInAnyOrder) {
  const size_t count = 3 * kPieceRows + 5;
  const std::string content = one_chunk(count);
  const Result<std::unique_ptr<RowSource>> rows = las_rows(testing::as_bytes(content));
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ((*rows)->pieces(), 4U);
  for (const size_t piece : {1, 3, 0, 2, 2}) {
    const Result<PointTable> table = (*rows)->read(piece);
    ASSERT_TRUE(table);
    EXPECT_EQ(table->rows, std::min(kPieceRows, count - piece * kPieceRows));
    EXPECT_EQ(laz::load<int32_t>(table->records.data()), static_cast<int32_t>(piece * kPieceRows));
  }
}

TEST(LazReaderTest, ACompressedFileWithoutTheRecordOfLaszipIsRefused) {
  std::string content = testing::file_content(data_file("indoor.laz"));
  content[content.find("laszip encoded")] = 'L';
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(content), "scan.laz");
  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("without a LASzip record"));
}

}  // namespace
}  // namespace surfcast::scan
