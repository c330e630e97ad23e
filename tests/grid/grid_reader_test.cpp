#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grid/grid_files.h"
#include "support/packing.h"

namespace surfcast::grid {
namespace {

using testing::GridSample;
using ::testing::HasSubstr;
using testing::kRamp;
using testing::write;

TEST(GridReaderTest, EveryFormatIsRecognisedByContent) {
  const model::TestFolder folder;
  for (const GridSample& sample : testing::grid_samples()) {
    SCOPED_TRACE(sample.name);
    const GridHeader header = testing::expect_ramp(write(folder / "file", sample.text));
    EXPECT_EQ(header.size, (std::array<uint64_t, 3>{3, 2, 2}));
    EXPECT_EQ(header.type, ScalarType::kInt16);
    EXPECT_EQ(header.slope, 1);
    EXPECT_EQ(header.intercept, 0);
  }
}

TEST(GridReaderTest, RunsAndSeeksYieldTheSamplesOfAWholeReading) {
  const model::TestFolder folder;
  for (const GridSample& sample : testing::grid_samples()) {
    SCOPED_TRACE(sample.name);
    Result<GridReader> reader = GridReader::open(write(folder / "file", sample.text));
    ASSERT_TRUE(reader) << reader.error().message;
    std::vector<int16_t> part(2);
    for (const uint64_t first : {0, 2, 10, 3, 7, 0, 10}) {
      ASSERT_TRUE(reader->seek(first));
      ASSERT_TRUE(reader->read(std::as_writable_bytes(std::span(part))));
      EXPECT_EQ(part[0], kRamp[first]) << first;
      EXPECT_EQ(part[1], kRamp[first + 1]) << first;
      EXPECT_EQ(reader->position(), first + 2);
    }
  }
}

TEST(GridReaderTest, EveryTruncationFails) {
  const model::TestFolder folder;
  for (const GridSample& sample : testing::grid_samples()) {
    SCOPED_TRACE(sample.name);
    // Text and XML may end behind the last number.
    const bool text = sample.name.starts_with("text");
    const size_t whole =
        sample.name.ends_with(".vti") ? sample.text.find(text ? "7 </Data" : "</") : sample.text.size();
    for (size_t size = 0; size < whole - (text ? 1 : 0); ++size) {
      EXPECT_NE(testing::fault_of(write(folder / "file", sample.text.substr(0, size))), "") << size;
    }
  }
}

TEST(GridReaderTest, DamagedFilesFailOrYieldSamplesButNothingElse) {
  const model::TestFolder folder;
  std::mt19937 random(7);
  for (const GridSample& sample : testing::grid_samples()) {
    SCOPED_TRACE(sample.name);
    for (int round = 0; round < 200; ++round) {
      std::string text = sample.text;
      for (int i = 0; i < 3; ++i) text[random() % text.size()] = static_cast<char>(random());
      Result<GridReader> reader = GridReader::open(write(folder / "file", text));
      // A reader that opens can hold its samples, so that they are few here.
      if (reader) (void)testing::read_values(*reader);
    }
  }
}

TEST(GridReaderTest, OtherFilesAreNoGrids) {
  const model::TestFolder folder;
  EXPECT_THAT(testing::fault_of(write(folder / "a", "")), HasSubstr("the file is empty"));
  EXPECT_THAT(testing::fault_of(write(folder / "b", "ply\nformat ascii 1.0\n")), HasSubstr("not a grid"));
  EXPECT_THAT(testing::fault_of(write(folder / "c", testing::gzip("text"))), HasSubstr("not a grid"));
  EXPECT_THAT(testing::fault_of(folder / "missing"), HasSubstr("missing"));
}

TEST(GridReaderTest, DamageBehindTheLastSampleIsFound) {
  const model::TestFolder folder;
  std::string packed = testing::gzip(testing::ramp_bytes());
  packed[packed.size() - 6] ^= 1;  // of the checksum
  const std::string head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 2 2\nendian: little\nencoding: gzip\n\n";
  EXPECT_THAT(testing::fault_of(write(folder / "file", head + packed)), HasSubstr("incorrect data check"));
}

}  // namespace
}  // namespace surfcast::grid
