#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "laz/byte_access.h"
#include "laz/laz_writer.h"
#include "scan/bytes.h"
#include "scan/copc_index.h"
#include "scan/las_file.h"
#include "scan/las_header.h"
#include "scan/las_reader.h"
#include "scan/selected_rows.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using ::testing::HasSubstr;

struct Node {
  int32_t level, x, y;
};

constexpr int32_t kLevels = 6;
constexpr int32_t kSide = 32000;  // of the root, steps of 0.01
constexpr size_t kNodePoints = 200;
constexpr int32_t kPageLevel = 3;  // nodes from here on have pages of their own

/// A flat octree with as many points in every node: level by level.
std::vector<Node> all_nodes() {
  std::vector<Node> nodes;
  for (int32_t level = 0; level < kLevels; ++level) {
    for (int32_t i = 0; i < 1 << level * 2; ++i) nodes.push_back({level, i % (1 << level), i >> level});
  }
  return nodes;
}

std::vector<std::byte> records_of(const std::vector<Node>& nodes) {
  std::mt19937 random(4);
  std::vector<std::byte> records(nodes.size() * kNodePoints * 30);
  std::byte* at = records.data();
  for (const Node& node : nodes) {
    const int32_t side = kSide >> node.level;
    for (size_t i = 0; i < kNodePoints; ++i, at += 30) {
      laz::store(at, node.x * side + static_cast<int32_t>(random() % static_cast<uint32_t>(side)));
      laz::store(at + 4, node.y * side + static_cast<int32_t>(random() % static_cast<uint32_t>(side)));
      at[14] = std::byte{0x11};
      at[16] = static_cast<std::byte>(random() % 5);
    }
  }
  return records;
}

std::string variable_record(std::string_view user, uint16_t id, std::string_view body) {
  testing::Bytes head(std::string(54, '\0'));
  head.set(18, id).set(20, static_cast<uint16_t>(body.size()));
  std::string text = head.text();
  text.replace(2, user.size(), user);
  return text + std::string(body);
}

std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string entry(const Node& node, uint64_t offset, int32_t bytes, int32_t points) {
  return testing::Bytes()
      .add(node.level)
      .add(node.x)
      .add(node.y)
      .add(int32_t{0})
      .add(offset)
      .add(bytes)
      .add(points)
      .text();
}

/// The pages below one node each, and before them the root page, which ends up last in the file.
struct Hierarchy {
  std::string pages;
  uint64_t root = 0;
  uint64_t root_bytes = 0;
};

Hierarchy hierarchy_of(const std::vector<Node>& nodes, std::span<const laz::Chunk> chunks, uint64_t place) {
  const auto line = [&](size_t i) {
    return entry(nodes[i], chunks[i].offset, static_cast<int32_t>(chunks[i].size), kNodePoints);
  };
  Hierarchy hierarchy;
  std::string root;
  for (size_t i = 0; i < nodes.size() && nodes[i].level < kPageLevel; ++i) root += line(i);
  for (const Node& top : nodes) {
    if (top.level != kPageLevel) continue;
    std::string page;
    for (size_t i = 0; i < nodes.size(); ++i) {
      const int32_t down = nodes[i].level - kPageLevel;
      if (down >= 0 && nodes[i].x >> down == top.x && nodes[i].y >> down == top.y) page += line(i);
    }
    root += entry(top, place + hierarchy.pages.size(), static_cast<int32_t>(page.size()), -1);
    hierarchy.pages += page;
  }
  hierarchy.root = place + hierarchy.pages.size();
  hierarchy.root_bytes = root.size();
  hierarchy.pages += root;
  return hierarchy;
}

/// A COPC file. The info record is the first, as the specification has it.
std::string copc_file() {
  const std::vector<Node> nodes = all_nodes();
  const std::vector<std::byte> records = records_of(nodes);
  laz::testing::LazWriter writer;
  writer.point_format = 6;
  writer.record_length = 30;
  writer.variable_chunks = true;
  writer.chunk_sizes.assign(nodes.size(), kNodePoints);
  testing::LasFile file;
  file.minor = 4;
  file.format = 6;
  file.variable_record_count = 2;
  const std::vector<std::byte> coding = writer.laszip_record();
  file.variable_records =
      variable_record("copc", 1, std::string(160, '\0')) + variable_record("laszip encoded", 22204, text_of(coding));
  std::string head = file.text();
  const std::vector<std::byte> data = writer.point_data(records, head.size());
  const size_t data_offset = head.size();
  const std::string whole = head + std::string(text_of(data));
  const laz::LazPoints points{6, 30, nodes.size() * kNodePoints, data_offset};
  const auto laz = laz::LazFile::open(testing::as_bytes(whole), points, coding);
  const Hierarchy hierarchy = hierarchy_of(nodes, laz->chunks(), whole.size());
  testing::Bytes copc(whole + hierarchy.pages);
  copc.set<uint8_t>(104, 0x80 | 6).set<uint64_t>(247, points.count);
  constexpr size_t kInfo = 375 + 54;
  for (const size_t axis : {0, 1, 2}) copc.set(kInfo + 8 * axis, 160.0);
  copc.set(kInfo + 24, 160.0).set(kInfo + 40, hierarchy.root).set(kInfo + 48, hierarchy.root_bytes);
  return copc.text();
}

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
  if (!rows) return fail(rows.error());
  Points points;
  for (size_t piece = 0; piece < (*rows)->pieces(); ++piece) {
    const Result<PointTable> table = (*rows)->read(piece);
    if (!table) return fail(table.error());
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
  ASSERT_EQ(all->positions.size(), all_nodes().size() * kNodePoints);
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
  const auto nodes = read_copc_nodes(bytes, header->copc_record, {{box_of(80.5, 80.5, 32)}, {}});
  ASSERT_TRUE(nodes) << nodes.error().message;
  uint64_t sum = header->data_offset + nodes->page_bytes;
  for (const laz::Chunk& chunk : nodes->chunks) sum += chunk.size;
  EXPECT_LT(static_cast<double>(sum), 0.03 * static_cast<double>(file_.size()));
}

TEST_F(CopcTest, EveryNthPointOfEachPieceCanBeRead) {
  Selection selection;
  selection.every = 10;
  const Result<Points> tenth = read(file_, selection);
  ASSERT_TRUE(tenth);
  EXPECT_EQ(tenth->positions.size(), all_nodes().size() * kNodePoints / 10);
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
