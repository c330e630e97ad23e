#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/test_folder.h"
#include "scan/bytes.h"
#include "scan/readers.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;
using testing::as_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Three columns and two rows of cells of 2 x 2 about the corner (10, 20); one has no value.
const std::string kHeader = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -9999\n";
const std::string kCells = "1 2.5 3\n-9999 5 6\n";

Result<testing::WholeScan> read(const std::string& text) {
  return testing::read_whole(as_bytes(text), "heights.asc");
}

std::string grid_error(const std::string& text) {
  const Result<testing::WholeScan> points = read(text);
  return points ? "no error" : points.error().message;
}

TEST(AsciiGridReaderTest, CellsWithValuesArePointsInTheirMiddlesFromTheNorth) {
  const Result<testing::WholeScan> points = read(kHeader + kCells);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(11, 23, 1), glm::dvec3(13, 23, 2.5), glm::dvec3(15, 23, 3),
                                             glm::dvec3(13, 21, 5), glm::dvec3(15, 21, 6)));
  EXPECT_TRUE(points->z_up);
}

TEST(AsciiGridReaderTest, NamesAreOfAnyCaseInAnyOrderAndRowsMayBreakAnywhere) {
  const Result<testing::WholeScan> points =
      read("NCOLS 3\r\nNROWS 2\r\nCELLSIZE 2\r\nYLLCENTER 21\r\nXLLCENTER 11\r\n1 2.5\r\n3 4 5\r\n6\r\n");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 6U);
  EXPECT_EQ(points->positions[0], glm::dvec3(11, 23, 1));
  EXPECT_EQ(points->positions[3], glm::dvec3(11, 21, 4));
}

TEST(AsciiGridReaderTest, CellsMayBeOblong) {
  const Result<testing::WholeScan> points =
      read("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ndx 2\ndy 4\n1 2\n3 nan\n");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 6, 1), glm::dvec3(3, 6, 2), glm::dvec3(1, 2, 3)));
}

TEST(AsciiGridReaderTest, PiecesBeginWhereTheirCellsAre) {
  // 600 x 900 cells are three pieces; the value of a cell is its number.
  std::string text = "ncols 600\nnrows 900\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  for (int i = 0; i < 600 * 900; ++i) text += std::to_string(i) + (i % 600 == 599 ? '\n' : ' ');
  const Result<testing::WholeScan> points = read(text);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 600U * 900U);
  for (size_t i = 0; i < points->size(); i += 997) {
    ASSERT_EQ(points->positions[i],
              glm::dvec3(static_cast<double>(i % 600), 899 - static_cast<double>(i / 600), static_cast<double>(i)));
  }
}

TEST(AsciiGridReaderTest, DefectsAreNamed) {
  EXPECT_THAT(grid_error("ncols 3\nxllcorner 1\n" + kCells), HasSubstr("ASCII grid: nrows is missing"));
  EXPECT_THAT(grid_error("ncols 3\nnrows 2\nxllcorner 1\ncellsize 1\n1"), HasSubstr("yllcorner is missing"));
  EXPECT_THAT(grid_error("ncols 3\nnrows 2\nxllcorner 1\nyllcorner 1\n1"), HasSubstr("cellsize is missing"));
  EXPECT_THAT(grid_error("ncols 3\nnrows 0\nxllcorner 1\nyllcorner 1\ncellsize 1\n1"),
              HasSubstr("nrows is not a number of cells"));
  EXPECT_THAT(grid_error("ncols 3\nnrows x\n"), HasSubstr("nrows is not a number: x"));
  EXPECT_THAT(grid_error("ncols 3\nnrows 2\nxllcorner 1\nyllcorner 1\ncellsize -1\n1"), HasSubstr("not positive"));
  EXPECT_THAT(grid_error(kHeader + "1 2 3 4 5"), HasSubstr("truncated: 5 of 6 cells"));
  EXPECT_THAT(grid_error(kHeader + kCells + "7"), HasSubstr("more than 6 cells"));
  EXPECT_THAT(grid_error(kHeader + "1 2,5 3 4 5 6"), HasSubstr("a cell is not a number: 2,5"));
  EXPECT_THAT(grid_error("ncols 1\nnrows 1\nxllcorner 1\nyllcorner 1\ncellsize 1\nnodata_value 0\n0\n"),
              HasSubstr("has no points"));
  EXPECT_THAT(grid_error("ncols 4e9\nnrows 4e9\nxllcorner 1\nyllcorner 1\ncellsize 1\n1 2"),
              HasSubstr("truncated: 2 of 16000000000000000000 cells"));
}

class ProjectionFileTest : public ::testing::Test {
 protected:
  Result<ScanStream> open_beside(const std::string& projection) {
    std::ofstream(folder_ / "dem.asc") << kHeader << kCells;
    std::ofstream(folder_ / "dem.prj") << projection;
    return ScanStream::open(folder_ / "dem.asc");
  }

  model::TestFolder folder_;
};

TEST_F(ProjectionFileTest, StatesTheCoordinateSystem) {
  const std::string wkt = "PROJCS[\"WGS_1984_UTM_Zone_32N\"]";
  const Result<ScanStream> scan = open_beside(wkt);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->schema().crs, wkt);
  EXPECT_TRUE(scan->schema().notes.empty());
}

TEST_F(ProjectionFileTest, OfAnotherFormIsIgnoredWithANote) {
  const Result<ScanStream> scan = open_beside("Projection    UTM\nZone          32\n");
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->schema().crs, "");
  EXPECT_THAT(scan->schema().notes, ElementsAre(HasSubstr("dem.prj states no coordinate system as WKT")));
}

}  // namespace
}  // namespace surfcast::scan
