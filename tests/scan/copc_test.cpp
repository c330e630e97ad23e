#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/memory_source.h"
#include "laz/byte_access.h"
#include "scan/bytes.h"
#include "scan/copc_file.h"
#include "scan/copc_index.h"
#include "scan/las_file.h"
#include "scan/las_header.h"
#include "scan/las_reader.h"
#include "scan/selected_rows.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::all_nodes;
using testing::copc_file;
using testing::CopcShape;
using ::testing::HasSubstr;

geometry::Box box_of(double x, double y, double side) {
  geometry::Box box;
  box.min = {x, y, -1};
  box.max = {x + side, y + side, 1};
  return box;
}

struct Points {
  std::vector<glm::dvec3> positions;
  std::vector<uint8_t> classes;
};

Result<Points> read(const std::string& content, const Selection& selection) {
  Result<std::unique_ptr<RowSource>> rows =
      las_rows(testing::as_bytes(content), selection).and_then([&](std::unique_ptr<RowSource> all) {
        return select_rows(std::move(all), selection);
      });
  if (!rows) return fail(rows);
  Points points;
  for (size_t piece = 0; piece < (*rows)->pieces(); ++piece) {
    const Result<PointTable> table = (*rows)->read(piece);
    if (!table) return fail(table);
    for (size_t i = 0; i < table->rows; ++i) {
      glm::dvec3 p;
      for (size_t axis = 0; axis < 3; ++axis) {
        p[static_cast<int>(axis)] = load<double>(table->columns[axis].first + i * table->columns[axis].stride);
      }
      points.positions.push_back(p);
      points.classes.push_back(load<uint8_t>(table->columns[10].first + i * table->columns[10].stride));
    }
  }
  return points;
}

class CopcTest : public ::testing::Test {
 protected:
  CopcTest() {
    static const std::string kFile = copc_file();
    file_ = kFile;
  }
  std::string file_;
};

TEST_F(CopcTest, ASelectedBoxHasThePointsThatTheWholeFileHasThere) {
  const Result<Points> all = read(file_, {});
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->positions.size(), all_nodes().size() * CopcShape().node_points);
  Selection selection;
  selection.zone.boxes = {box_of(100, 37, 25)};
  selection.classes = {2, 4};
  Points expected;
  for (size_t i = 0; i < all->positions.size(); ++i) {
    if (!geometry::contains(selection.zone.boxes[0], all->positions[i]) ||
        (all->classes[i] != 2 && all->classes[i] != 4))
      continue;
    expected.positions.push_back(all->positions[i]);
    expected.classes.push_back(all->classes[i]);
  }
  const Result<Points> some = read(file_, selection);
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_GT(some->positions.size(), 100U);
  EXPECT_EQ(some->positions, expected.positions);
  EXPECT_EQ(some->classes, expected.classes);
}

TEST_F(CopcTest, OfAHundredthOfTheAreaAtMostThreeHundredthsOfTheBytesAreRead) {
  const auto bytes = testing::as_bytes(file_);
  const Result<LasHeader> header = parse_las_header(bytes);
  ASSERT_TRUE(header);
  const Result<CopcInfo> info = read_copc_info(header->copc_record);
  ASSERT_TRUE(info);
  const auto nodes = read_copc_nodes(MemorySource(bytes), *info, {{box_of(80.5, 80.5, 32)}, {}});
  ASSERT_TRUE(nodes) << nodes.error().message;
  uint64_t sum = header->data_offset + nodes->page_bytes;
  for (const CopcNode& node : nodes->nodes) sum += node.chunk.size;
  EXPECT_LT(static_cast<double>(sum), 0.03 * static_cast<double>(file_.size()));
}

TEST_F(CopcTest, EveryNthPointOfEachPieceCanBeRead) {
  Selection selection;
  selection.every = 10;
  const Result<Points> tenth = read(file_, selection);
  ASSERT_TRUE(tenth);
  EXPECT_EQ(tenth->positions.size(), all_nodes().size() * CopcShape().node_points / 10);
}

std::string error_with(std::string file, size_t offset, uint64_t number) {
  laz::store(reinterpret_cast<std::byte*>(&file[offset]), number);
  Selection selection;
  selection.zone.boxes = {box_of(0, 0, 320)};
  const Result<Points> points = read(file, selection);
  return points ? "" : points.error().message;
}

TEST_F(CopcTest, DamagedHierarchiesAreNamed) {
  constexpr size_t kInfo = 375 + 54;
  const size_t root = laz::load<uint64_t>(reinterpret_cast<const std::byte*>(&file_[kInfo + 40]));
  const size_t link = root + 32 * 21;  // the first page of another
  EXPECT_THAT(error_with(file_, kInfo + 24, 0), HasSubstr("no size of the root"));
  EXPECT_THAT(error_with(file_, kInfo + 40, file_.size()), HasSubstr("beyond the end"));
  EXPECT_THAT(error_with(file_, kInfo + 48, 33), HasSubstr("a size that cannot be"));
  EXPECT_THAT(error_with(file_, link + 16, root), HasSubstr("within itself"));
  EXPECT_THAT(error_with(file_, root + 16, file_.size()), HasSubstr("beyond the points"));
  EXPECT_THAT(error_with(file_, root, 99), HasSubstr("entry of the COPC hierarchy is damaged"));
}

TEST(SelectionTest, ClassesOfAScanWithoutClassesAreAnError) {
  Selection selection;
  selection.classes = {2};
  testing::LasFile file;
  file.records = {file.record(1, 2, 3).text()};
  const std::string text = file.text();
  EXPECT_TRUE(read(text, selection)) << "LAS has classes, none of which is 2";
}

}  // namespace
}  // namespace surfcast::scan
