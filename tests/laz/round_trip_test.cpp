#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "laz/laz_writer.h"
#include "laz/sample_records.h"

namespace surfcast::laz {
namespace {

using Records = std::vector<std::byte>;
using testing::LazWriter;
using testing::sample_records;

/// All records of a file, read in pieces of `at_once` points.
Records read_all(const LazFile& file, size_t at_once) {
  Records all;
  for (const Chunk& chunk : file.chunks()) {
    Result<LazChunkReader> reader = file.read_chunk(chunk);
    EXPECT_TRUE(reader) << reader.error().message;
    for (size_t done = 0; reader && done < chunk.count; done += at_once) {
      Records piece(std::min<size_t>(at_once, chunk.count - done) * file.record_length());
      const Status status = reader->read(piece);
      EXPECT_TRUE(status) << status.error().message;
      all.insert(all.end(), piece.begin(), piece.end());
    }
  }
  return all;
}

Records round_trip(const LazWriter& writer, const Records& records, size_t at_once = 1000) {
  const Records data = writer.point_data(records);
  const Result<LazFile> file = LazFile::open(data, writer.points(records), writer.laszip_record());
  EXPECT_TRUE(file) << file.error().message;
  return file ? read_all(*file, at_once) : Records();
}

size_t plain_length(int point_format) {
  constexpr size_t kLengths[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  return kLengths[point_format];
}

LazWriter writer_of(int point_format, size_t extra_bytes = 0) {
  LazWriter writer;
  writer.point_format = point_format;
  writer.record_length = plain_length(point_format) + extra_bytes;
  return writer;
}

class LazFormatTest : public ::testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(AllFormats, LazFormatTest, ::testing::Range(0, 11));

TEST_P(LazFormatTest, RecordsComeBackAsTheyWere) {
  const LazWriter writer = writer_of(GetParam());
  const Records records = sample_records(writer.record_length, 3000);
  EXPECT_EQ(round_trip(writer, records), records);
}

TEST_P(LazFormatTest, LongChunksHalveTheirCountsAndGoOn) {
  LazWriter writer = writer_of(GetParam());
  writer.chunk_size = 50000;
  const Records records = sample_records(writer.record_length, 50000);
  EXPECT_EQ(round_trip(writer, records), records);
}

TEST_P(LazFormatTest, ExtraBytesComeBackAsTheyWere) {
  const LazWriter writer = writer_of(GetParam(), 5);
  const Records records = sample_records(writer.record_length, 1000);
  EXPECT_EQ(round_trip(writer, records), records);
}

TEST_P(LazFormatTest, ChunksMayBeReadInPiecesOfAnySize) {
  const LazWriter writer = writer_of(GetParam(), 2);
  const Records records = sample_records(writer.record_length, 333);
  for (const size_t at_once : {1, 7, 49, 50}) EXPECT_EQ(round_trip(writer, records, at_once), records) << at_once;
}

TEST_P(LazFormatTest, ChunksOfVariableSizeAreRead) {
  LazWriter writer = writer_of(GetParam());
  writer.variable_chunks = true;
  writer.chunk_sizes = {1, 700, 0, 2, 50, 247};
  const Records records = sample_records(writer.record_length, 1000);
  EXPECT_EQ(round_trip(writer, records), records);
}

TEST_P(LazFormatTest, RandomRecordsComeBackAsTheyWere) {
  const LazWriter writer = writer_of(GetParam(), 1);
  std::mt19937 random(7);
  Records records(writer.record_length * 500);
  for (std::byte& byte : records) byte = static_cast<std::byte>(random());
  EXPECT_EQ(round_trip(writer, records), records);
}

TEST_P(LazFormatTest, APointThatNeverChangesTakesNextToNothing) {
  LazWriter writer = writer_of(GetParam(), 3);
  writer.chunk_size = 50000;
  Records records;
  const Records one = sample_records(writer.record_length, 1);
  for (int i = 0; i < 20000; ++i) records.insert(records.end(), one.begin(), one.end());
  EXPECT_EQ(round_trip(writer, records), records);
  EXPECT_LT(writer.point_data(records).size(), records.size() / 200);
}

TEST_P(LazFormatTest, TheTablesOffsetMayStandAtTheEndOfTheFile) {
  LazWriter writer = writer_of(GetParam());
  writer.offset_at_end = true;
  const Records records = sample_records(writer.record_length, 200);
  EXPECT_EQ(round_trip(writer, records), records);
}

TEST(LazRoundTripTest, ScannerChannelsAreFollowedInAllVersionsOfTheLayeredItems) {
  for (const uint16_t version : std::to_array<uint16_t>({2, 3, 4})) {
    LazWriter writer = writer_of(10, 2);
    writer.layered_version = version;
    Records records = sample_records(writer.record_length, 2000);
    std::mt19937 random(3);
    for (size_t at = 15; at < records.size(); at += writer.record_length) {
      if (random() % 3 == 0) records[at] ^= static_cast<std::byte>(random() % 4 << 4);
    }
    EXPECT_EQ(round_trip(writer, records), records) << version;
  }
}

/// Records of format 1 or 6 with these GPS times, and no other changes.
Records with_times(const LazWriter& writer, const std::vector<double>& times) {
  const Records one = sample_records(writer.record_length, 1);
  Records records;
  for (const double time : times) {
    records.insert(records.end(), one.begin(), one.end());
    store(&records[records.size() - writer.record_length + (writer.point_format < 6 ? 20 : 22)], time);
  }
  return records;
}

TEST(LazRoundTripTest, GpsTimesMayJumpAndSwitchBetweenSequences) {
  std::vector<double> times = {
      0, 0, -0.0, 1e-300, 1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(),
      5, 5, 5};
  for (int i = 0; i < 600; ++i) times.push_back(100000 * (i % 5) + 1e-5 * i);     // five sources in turn
  for (int i = 0; i < 600; ++i) times.push_back(2e5 + 1e-6 * i * (i % 7 - 3));    // steps back and forth
  for (int i = 0; i < 600; ++i) times.push_back(3e5 + 1e-9 * std::pow(1.03, i));  // ever larger multiples
  for (const int format : {1, 6}) {
    const LazWriter writer = writer_of(format);
    const Records records = with_times(writer, times);
    EXPECT_EQ(round_trip(writer, records), records) << format;
  }
}

TEST(LazRoundTripTest, CoordinatesMayJumpFromOneEndOfTheirRangeToTheOther) {
  for (const int format : {0, 6}) {
    const LazWriter writer = writer_of(format);
    Records records = sample_records(writer.record_length, 64);
    for (size_t i = 0; i < 64; ++i) {
      const int32_t ends[] = {std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max(), 0, -1};
      for (size_t axis = 0; axis < 3; ++axis) {
        store(&records[i * writer.record_length + 4 * axis], ends[(i >> axis) % 4]);
      }
    }
    EXPECT_EQ(round_trip(writer, records), records) << format;
  }
}

TEST_P(LazFormatTest, FilesWithMorePointsThanTheHeaderStatesAreReadAsFarAsItStates) {
  for (const bool variable_chunks : {false, true}) {
    LazWriter writer = writer_of(GetParam());
    writer.variable_chunks = variable_chunks;
    writer.chunk_sizes = {60, 30, 60};
    const Records records = sample_records(writer.record_length, 150);
    const Records data = writer.point_data(records);
    LazPoints points = writer.points(records);
    points.count = 70;
    const Result<LazFile> file = LazFile::open(data, points, writer.laszip_record());
    ASSERT_TRUE(file) << file.error().message;
    const Records first(records.begin(), records.begin() + static_cast<ptrdiff_t>(70 * writer.record_length));
    EXPECT_EQ(read_all(*file, 1000), first);
  }
}

TEST(LazRoundTripTest, ChunksSayWhichPointsTheyHold) {
  const LazWriter writer = writer_of(0);
  const Records records = sample_records(20, 120);
  const Records data = writer.point_data(records);
  const Result<LazFile> file = LazFile::open(data, writer.points(records), writer.laszip_record());
  ASSERT_TRUE(file);
  ASSERT_EQ(file->chunks().size(), 3U);
  EXPECT_EQ(file->chunks()[2].first, 100U);
  EXPECT_EQ(file->chunks()[2].count, 20U);
  Records last(20 * 20);
  ASSERT_TRUE(file->read_chunk(file->chunks()[2])->read(last));
  EXPECT_TRUE(std::equal(last.begin(), last.end(), records.end() - 400));
}

}  // namespace
}  // namespace surfcast::laz
