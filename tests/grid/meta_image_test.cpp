#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grid/grid_files.h"
#include "support/packing.h"

namespace surfcast::grid {
namespace {

using testing::expect_ramp;
using testing::fault_of;
using ::testing::HasSubstr;
using testing::ramp_bytes;
using testing::world;
using testing::write;

/// A header of the ramp with additional keys, and where its samples are.
std::string header(const std::string& keys, const std::string& file) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 3 2 2\nElementType = MET_SHORT\n" + keys +
         "ElementDataFile = " + file + "\n";
}

TEST(MetaImageTest, BothByteOrdersAreRead) {
  const model::TestFolder folder;
  expect_ramp(write(folder / "a.mha", header("ElementByteOrderMSB = False\n", "LOCAL") + ramp_bytes()));
  expect_ramp(write(folder / "b.mha", header("BinaryDataByteOrderMSB = True\r\n", "LOCAL") + ramp_bytes(true)));
}

TEST(MetaImageTest, SamplesAreFoundBesideTheHeaderInAListAndAPattern) {
  const model::TestFolder folder;
  write(folder / "all.raw", ramp_bytes());
  write(folder / "s1.raw", ramp_bytes().substr(0, 12));
  write(folder / "s2.raw", ramp_bytes().substr(12));
  write(folder / "all.zraw", testing::zlib(ramp_bytes()));
  write(folder / "headed.raw", "some header" + ramp_bytes());
  expect_ramp(write(folder / "a.mhd", header("", "all.raw")));
  expect_ramp(write(folder / "b.mhd", header("", "LIST") + "s1.raw\ns2.raw\n"));
  expect_ramp(write(folder / "c.mhd", header("", "s%d.raw 1 2 1")));
  expect_ramp(write(folder / "d.mhd", header("CompressedData = True\nCompressedDataSize = 9\n", "all.zraw")));
  expect_ramp(write(folder / "e.mhd", header("HeaderSize = -1\n", "headed.raw")));
  expect_ramp(write(folder / "f.mhd", header("HeaderSize = 11\n", "headed.raw")));
}

TEST(MetaImageTest, DirectionsSpacingAndOffsetPlaceSamplesInTheWorld) {
  const model::TestFolder folder;
  // Axis 0 runs along y, axis 1 against x: a row of the matrix is the direction of an axis.
  const GridHeader placed = expect_ramp(write(
      folder / "a.mha", header("TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 -4\n"
                               "AnatomicalOrientation = RAI\n",
                               "LOCAL") +
                            ramp_bytes()));
  EXPECT_EQ(world(placed, 0, 0, 0), glm::dvec3(10, 20, 30));
  EXPECT_EQ(world(placed, 1, 0, 0), glm::dvec3(10, 22, 30));
  EXPECT_EQ(world(placed, 0, 1, 1), glm::dvec3(7, 20, 26));
  EXPECT_EQ(placed.frame, WorldFrame::kLps);
  const GridHeader sized = expect_ramp(
      write(folder / "b.mha",
            header("ElementSize = 2 2 2\nPosition = 1 1 1\nAnatomicalOrientation = ???\n", "LOCAL") + ramp_bytes()));
  EXPECT_EQ(world(sized, 1, 1, 1), glm::dvec3(3, 3, 3));
  EXPECT_EQ(sized.frame, WorldFrame::kUnstated);
}

TEST(MetaImageTest, SlopeAndOffsetOfIntensityAreStatedAndNotApplied) {
  const model::TestFolder folder;
  const GridHeader scaled = expect_ramp(
      write(folder / "a.mha",
            header("ElementToIntensityFunctionSlope = 0.5\nElementToIntensityFunctionOffset = -1024\n", "LOCAL") +
                ramp_bytes()));
  EXPECT_EQ(scaled.slope, 0.5);
  EXPECT_EQ(scaled.intercept, -1024);
}

TEST(MetaImageTest, LongHasFourBytesOnEveryMachine) {
  const model::TestFolder folder;
  const std::string text = "NDims = 1\nDimSize = 2\nElementType = MET_LONG\nElementDataFile = LOCAL\n" +
                           testing::packed_numbers(std::vector<int32_t>{-7, 70000});
  Result<GridReader> reader = GridReader::open(write(folder / "a.mha", text));
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_THAT(testing::read_values(*reader).value(), ::testing::ElementsAre(-7, 70000));
  EXPECT_EQ(reader->header().size, (std::array<uint64_t, 3>{2, 1, 1}));
}

TEST(MetaImageTest, WhatIsNotReadIsNamed) {
  const model::TestFolder folder;
  const auto fault = [&](const std::string& text) { return fault_of(write(folder / "a.mhd", text + ramp_bytes())); };
  EXPECT_THAT(fault(header("ElementNumberOfChannels = 3\n", "LOCAL")), HasSubstr("3 channels"));
  EXPECT_THAT(fault(header("ElementType = MET_STRING\n", "LOCAL")), HasSubstr("MET_STRING"));
  EXPECT_THAT(fault(header("DimSize = 3 2 5\n", "LOCAL")), HasSubstr("truncated"));
  EXPECT_THAT(fault(header("DimSize = 3 2\n", "LOCAL")), HasSubstr("not a size for each dimension"));
  EXPECT_THAT(fault(header("DimSize = 3 -2 2\n", "LOCAL")), HasSubstr("not a size for each dimension"));
  EXPECT_THAT(fault(header("NDims = 4\nDimSize = 3 2 1 2\n", "LOCAL")), HasSubstr("more than three dimensions"));
  EXPECT_THAT(fault(header("ElementSpacing = 1 0 1\n", "LOCAL")), HasSubstr("do not span space"));
  EXPECT_THAT(fault(header("ElementSpacing = 1 1\n", "LOCAL")), HasSubstr("wrong numbers"));
  EXPECT_THAT(fault(header("HeaderSize = -5\n", "LOCAL")), HasSubstr("not a size of a header"));
  EXPECT_THAT(fault(header("", "/etc/passwd")), HasSubstr("not in its folder"));
  EXPECT_THAT(fault(header("", "LIST") + "../a\n"), HasSubstr("not in its folder"));
  EXPECT_THAT(fault("ObjectType = Image\nNDims = 3\n"), HasSubstr("a.mhd"));
}

}  // namespace
}  // namespace surfcast::grid
