#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "laz/laz_writer.h"
#include "laz/sample_records.h"

namespace surfcast::laz {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;
using testing::LazWriter;

/// A file without its LAS header.
struct Parts {
  LazPoints points;
  Bytes record;
  Bytes data;
};

Parts sample_file(int point_format, size_t record_length, bool variable_chunks = false) {
  LazWriter writer;
  writer.point_format = point_format;
  writer.record_length = record_length;
  writer.variable_chunks = variable_chunks;
  writer.chunk_sizes = {20, 40};
  writer.chunk_size = 30;
  const Bytes records = testing::sample_records(record_length, 60);
  return {writer.points(records), writer.laszip_record(), writer.point_data(records)};
}

/// Decodes as much as there is, no more at once than one would who does not trust the counts.
std::string first_error(const Parts& parts) {
  const Result<LazFile> file = LazFile::open(parts.data, parts.points, parts.record);
  if (!file) return file.error().message;
  Bytes records(size_t{1000} * parts.points.record_length);
  for (const Chunk& chunk : file->chunks()) {
    Result<LazChunkReader> reader = file->read_chunk(chunk);
    if (!reader) return reader.error().message;
    for (uint64_t left = chunk.count; left > 0;) {
      const size_t now = std::min<uint64_t>(left, 1000);
      const Status status = reader->read(std::span(records).first(now * parts.points.record_length));
      if (!status) return status.error().message;
      left -= now;
    }
  }
  return {};
}

class DamagedLazTest : public ::testing::TestWithParam<int> {
 protected:
  Parts file() const {
    constexpr size_t kLengths[] = {22, 30, 28, 36, 59, 65, 32, 38, 40, 61, 69};  // two extra bytes each
    return sample_file(GetParam(), kLengths[GetParam()], GetParam() % 2 == 1);
  }
};

INSTANTIATE_TEST_SUITE_P(AllFormats, DamagedLazTest, ::testing::Range(0, 11));

TEST_P(DamagedLazTest, EveryTruncationOfThePointsIsAnError) {
  Parts parts = file();
  EXPECT_EQ(first_error(parts), "");
  // The last bytes that a coder writes need not be there: the decoder takes zeros for them.
  parts.data.resize(parts.data.size() - 4);
  while (!parts.data.empty()) {
    parts.data.pop_back();
    ASSERT_NE(first_error(parts), "") << parts.data.size();
  }
}

TEST_P(DamagedLazTest, EveryTruncationOfTheRecordIsAnError) {
  Parts parts = file();
  while (!parts.record.empty()) {
    parts.record.pop_back();
    ASSERT_NE(first_error(parts), "") << parts.record.size();
  }
}

TEST_P(DamagedLazTest, ChangedBytesGiveErrorsOrPoints) {
  const Parts good = file();
  std::mt19937 random(5);
  int errors = 0;
  for (int i = 0; i < 1000; ++i) {
    Parts parts = good;
    Bytes& bytes = i % 5 == 0 ? parts.record : parts.data;
    for (auto flips = 1 + random() % 3; flips > 0; --flips) {
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
    }
    errors += first_error(parts).empty() ? 0 : 1;
  }
  EXPECT_GT(errors, 50);
}

TEST_P(DamagedLazTest, NoiseInAChunkGivesAnErrorOrPoints) {
  const Parts good = file();
  std::mt19937 random(6);
  const auto table = static_cast<size_t>(load<int64_t>(good.data.data()));
  for (int i = 0; i < 200; ++i) {
    Parts parts = good;
    for (size_t at = 8 + random() % 300; at < table; ++at) parts.data[at] = static_cast<std::byte>(random());
    first_error(parts);
  }
}

/// The error of a file of format 0 or 6, in chunks of 30 points, with one number of its record or data changed.
template <typename T>
std::string error_with_record(size_t offset, T number, int format = 0) {
  Parts parts = sample_file(format, format == 0 ? 20 : 30);
  store(&parts.record[offset], number);
  return first_error(parts);
}

template <typename T>
std::string error_with_data(size_t offset, T number, int format = 0, bool variable_chunks = false) {
  Parts parts = sample_file(format, format == 0 ? 20 : 30, variable_chunks);
  store(&parts.data[offset], number);
  return first_error(parts);
}

size_t table_of(const Parts& parts) {
  return static_cast<size_t>(load<int64_t>(parts.data.data()));
}

TEST(DamagedLazFileTest, CodingsThatAreNotSupportedAreNamed) {
  EXPECT_THAT(error_with_record<uint16_t>(0, 1), HasSubstr("written by LASzip 1"));
  EXPECT_THAT(error_with_record<uint16_t>(0, 3), HasSubstr("LAZ compressor 3"));
  EXPECT_THAT(error_with_record<uint16_t>(2, 1), HasSubstr("coder 1"));
  EXPECT_THAT(error_with_record<uint32_t>(12, 0), HasSubstr("chunks of no points"));
  EXPECT_THAT(error_with_record<uint16_t>(32, 2), HasSubstr("do not fit the point format"));
  EXPECT_THAT(error_with_record<uint16_t>(34, 7), HasSubstr("do not fit the point format"));
  EXPECT_THAT(error_with_record<uint16_t>(36, 28), HasSubstr("do not fit the point format"));
  EXPECT_THAT(error_with_record<uint16_t>(38, 1), HasSubstr("LAZ item type 6, version 1 is not supported"));
  EXPECT_THAT(error_with_record<uint16_t>(38, 5, 6), HasSubstr("LAZ item type 10, version 5 is not supported"));
}

TEST(DamagedLazFileTest, PointFormatsThatAreNotSupportedAreNamed) {
  for (const int format : {11, -1}) {
    Parts parts = sample_file(0, 20);
    parts.points.point_format = format;
    EXPECT_THAT(first_error(parts), HasSubstr("point format " + std::to_string(format) + " is not supported"));
  }
  Parts parts = sample_file(0, 20);
  parts.points.point_format = 3;
  EXPECT_THAT(first_error(parts), HasSubstr("too short for point format 3"));
}

TEST(DamagedLazFileTest, ChunkTablesThatCannotBeAreNamed) {
  const size_t table = table_of(sample_file(0, 20));
  EXPECT_THAT(error_with_data<int64_t>(0, 0), HasSubstr("not written to its end"));
  EXPECT_THAT(error_with_data<int64_t>(0, -1), HasSubstr("chunk table"));
  EXPECT_THAT(error_with_data<int64_t>(0, -2), HasSubstr("not written to its end"));
  EXPECT_THAT(error_with_data<int64_t>(0, int64_t{1} << 62), HasSubstr("beyond the end"));
  EXPECT_THAT(error_with_data<uint32_t>(table, 1), HasSubstr("table version 1"));
  EXPECT_THAT(error_with_data<uint32_t>(table + 4, 1), HasSubstr("1 chunks, 60 points need 2"));
  EXPECT_THAT(error_with_data<uint32_t>(table + 4, 0xFFFFFFFF), HasSubstr("more chunks than fit"));
  const size_t variable = table_of(sample_file(0, 20, true));
  EXPECT_THAT(error_with_data<uint32_t>(variable + 4, 0xFFFFFFFF, 0, true), HasSubstr("more chunks than fit"));
  EXPECT_THAT(error_with_data<uint32_t>(variable + 4, 1, 0, true), HasSubstr("hold 20 points, the header states 60"));
}

TEST(DamagedLazFileTest, ACountBeyondTheChunksIsAnError) {
  Parts parts = sample_file(0, 20);
  parts.points.count = uint64_t{1} << 60;
  EXPECT_THAT(first_error(parts), HasSubstr("chunks"));
  parts = sample_file(0, 20, true);
  parts.points.count = uint64_t{1} << 60;
  EXPECT_THAT(first_error(parts), HasSubstr("the header states"));
}

TEST(DamagedLazFileTest, LayersLongerThanTheirChunkAreAnError) {
  const size_t first_chunk = 8, count = first_chunk + 30, first_layer = count + 4;
  EXPECT_THAT(error_with_data<uint32_t>(count, 29, 6), HasSubstr("fewer points"));
  EXPECT_THAT(error_with_data<uint32_t>(first_layer, 0xFFFFFFFF, 6), HasSubstr("shorter than its layers"));
  EXPECT_THAT(error_with_data<uint32_t>(first_layer + 32, 0xFFFFFFFF, 6), HasSubstr("shorter than its layers"));
}

TEST(DamagedLazFileTest, AChunkWhosePointsHaveNoPositionsIsDamaged) {
  const size_t first_layer = 8 + 30 + 4;
  Parts parts = sample_file(6, 30);
  for (size_t layer = 0; layer < 9; ++layer) store(&parts.data[first_layer + 4 * layer], uint32_t{0});
  EXPECT_THAT(first_error(parts), HasSubstr("its points have no positions"));
}

TEST(DamagedLazFileTest, AChunkStatesNoMorePointsThanItsBytesCanHold) {
  LazWriter writer;
  writer.point_format = 6;
  writer.record_length = 30;
  writer.chunk_size = 0xFFFFFFFE;
  const Bytes records = testing::sample_records(30, 1);
  Parts parts = {writer.points(records), writer.laszip_record(), writer.point_data(records)};
  EXPECT_LT(parts.data.size(), 600U);
  parts.points.count = 40'000'000;
  const Result<LazFile> file = LazFile::open(parts.data, parts.points, parts.record);
  ASSERT_FALSE(file) << "before any memory is taken for the points";
  EXPECT_THAT(file.error().message, HasSubstr("40000000 points do not fit"));
}

/// The most that the coder can do: points that are all the same.
TEST(DamagedLazFileTest, PointsThatAreAllTheSameFitIntoTheirBytes) {
  for (const int format : {0, 6}) {
    LazWriter writer;
    writer.point_format = format;
    writer.record_length = format == 0 ? 20 : 30;
    writer.chunk_size = 0xFFFFFFFE;
    const Bytes records(writer.record_length * 500'000);
    const Parts parts = {writer.points(records), writer.laszip_record(), writer.point_data(records)};
    EXPECT_LT(parts.data.size(), records.size() / 5'000);
    EXPECT_EQ(first_error(parts), "");
  }
}

TEST(DamagedLazFileTest, AChunkThatEndsTooEarlyIsNotedWithinTheFirstPieces) {
  LazWriter writer;
  writer.chunk_size = 0xFFFFFFFE;
  const Bytes records = testing::sample_records(20, 60);
  Parts parts = {writer.points(records), writer.laszip_record(), writer.point_data(records)};
  parts.points.count = 4000000000U;
  EXPECT_THAT(first_error(parts), HasSubstr("damaged"));
}

}  // namespace
}  // namespace surfcast::laz
