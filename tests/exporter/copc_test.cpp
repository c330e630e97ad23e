#include <algorithm>
#include <fstream>
#include <glm/geometric.hpp>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include "base/scratch_folder.h"
#include "copc_content.h"
#include "exporter/export_scan.h"
#include "octree_scans.h"
#include "scan/las_records.h"
#include "scan/whole_scan.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::LasFile;

/// Nodes of a few points, so that small scans have trees.
ExportOptions small_nodes() {
  ExportOptions options;
  options.encoding.chunk_size = 200;
  return options;
}

class CopcTest : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& content) {
    std::ofstream(folder_->path() / name, std::ios::binary) << content;
    return folder_->path() / name;
  }
  [[nodiscard]] fs::path place(const std::string& name) const { return folder_->path() / name; }

  CopcContent exported(const fs::path& source, const ExportOptions& options = small_nodes()) {
    const auto report = export_scan(source, place("out.copc.laz"), options);
    EXPECT_TRUE(report) << report.error().message;
    if (report) {
      EXPECT_EQ(report->bytes, fs::file_size(place("out.copc.laz")));
    }
    return CopcContent(place("out.copc.laz"));
  }

  Result<ScratchFolder> folder_ = ScratchFolder::create(fs::temp_directory_path(), "copc-test-");
};

std::vector<std::string> sorted(std::vector<std::string> records) {
  std::ranges::sort(records);
  return records;
}

/// Every point is in the cube of its node, every node below another, every sample within reach.
void expect_octree(const CopcContent& copc) {
  std::set<std::array<int, 4>> keys;
  uint64_t points = 0;
  for (const CopcContentNode& node : copc.nodes()) {
    const std::array key{node.level, node.place.x, node.place.y, node.place.z};
    EXPECT_TRUE(keys.insert(key).second);
    EXPECT_GT(node.points, 0);
    const std::array parent{node.level - 1, node.place.x / 2, node.place.y / 2, node.place.z / 2};
    EXPECT_TRUE(node.level == 0 || keys.contains(parent));
    points += node.records.size();
    const glm::dvec3 low = copc.low_corner(node);
    const double tolerance = 1e-15 * (glm::length(low) + copc.half());
    for (const std::string& record : node.records) {
      const glm::dvec3 way = copc.position(record) - low;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(way[axis], -tolerance);
        EXPECT_LE(way[axis], copc.side(node) + tolerance);
      }
    }
  }
  EXPECT_EQ(points, copc.header().count);
}

class CopcFormatTest : public CopcTest, public ::testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(NewFormats, CopcFormatTest, ::testing::Values(6, 7, 8));

TEST_P(CopcFormatTest, EveryRecordComesBackOnceAndInItsNode) {
  const LasFile file = hills(GetParam());
  const CopcContent copc = exported(write("scan.las", file.text()));
  EXPECT_GT(copc.nodes().size(), 30U);
  EXPECT_EQ(copc.records(), sorted(file.records));
  EXPECT_EQ(copc.header().point_format, GetParam());
  expect_octree(copc);
  const auto records = scan::LasRecords::open(place("out.copc.laz"), {});
  ASSERT_TRUE(records) << records.error().message;
  size_t bytes = 0;
  for (size_t piece = 0; piece < records->pieces(); ++piece) bytes += records->read(piece)->size();
  EXPECT_EQ(bytes, file.records.size() * file.records.front().size());
}

TEST_F(CopcTest, RecordsOfOldFormatsBecomeThoseOfNewOnes) {
  for (int format = 0; format <= 5; ++format) {
    const LasFile file = hills(format, 700);
    const CopcContent copc = exported(write("scan.las", file.text()));
    EXPECT_EQ(copc.header().point_format, format == 2 || format == 3 || format == 5 ? 7 : 6);
    EXPECT_EQ(copc.header().count, 700U);
    expect_octree(copc);
    std::vector<std::string> places, expected;
    for (const std::string& record : copc.records()) places.push_back(record.substr(0, 14));
    for (const std::string& record : file.records) expected.push_back(record.substr(0, 14));
    EXPECT_EQ(sorted(places), sorted(expected)) << format;
  }
}

TEST_F(CopcTest, HeadersStateWhatTheFileHolds) {
  const LasFile file = hills(7);
  const CopcContent copc = exported(write("scan.las", file.text()));
  std::array<uint64_t, 15> returns{};
  double least = INFINITY, most = -INFINITY;
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const std::string& record : file.records) {
    if (const int number = record[14] & 15; number > 0) ++returns[static_cast<size_t>(number) - 1];
    const auto time = scan::load<double>(testing::as_bytes(record).data() + 22);
    least = std::min(least, time);
    most = std::max(most, time);
    low = glm::min(low, copc.position(record));
    high = glm::max(high, copc.position(record));
  }
  for (size_t i = 0; i < 15; ++i) EXPECT_EQ(copc.at<uint64_t>(255 + 8 * i), returns[i]);
  EXPECT_EQ(copc.least_time(), least);
  EXPECT_EQ(copc.most_time(), most);
  for (size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(copc.at<double>(179 + 16 * axis), high[static_cast<int>(axis)]);
    EXPECT_EQ(copc.at<double>(187 + 16 * axis), low[static_cast<int>(axis)]);
  }
  const glm::dvec3 size = high - low;
  EXPECT_NEAR(2 * copc.half(), std::max({size.x, size.y, size.z}), 0.0101);
  EXPECT_DOUBLE_EQ(copc.spacing(), copc.half() / 64);
  EXPECT_EQ(copc.header().crs, "PROJCS[\"somewhere\"]");
  EXPECT_EQ(copc.at<uint16_t>(6) & 16, 16);
  EXPECT_EQ(copc.at<uint8_t>(104), 7 | 0x80);
  EXPECT_EQ(copc.header().grid.scale, glm::dvec3(0.01, 0.01, 0.002));
  EXPECT_THAT(copc.text(), HasSubstr("something of theirs"));
}

TEST_F(CopcTest, ReadersOfLazFindTheChunksOfAllNodes) {
  const CopcContent copc = exported(write("scan.las", hills(6).text()));
  const scan::LasHeader& header = copc.header();
  const laz::LazPoints points{header.point_format, header.record_length, header.count, header.data_offset};
  const auto file = laz::LazFile::open(testing::as_bytes(copc.text()), points, header.laszip_record);
  ASSERT_TRUE(file) << file.error().message;
  std::set<std::array<uint64_t, 3>> chunks, nodes;
  for (const laz::Chunk& chunk : file->chunks()) chunks.insert({chunk.offset, chunk.size, chunk.count});
  for (const CopcContentNode& node : copc.nodes()) {
    nodes.insert({node.offset, static_cast<uint64_t>(node.bytes), static_cast<uint64_t>(node.points)});
  }
  EXPECT_EQ(chunks, nodes);
}

TEST_F(CopcTest, ALargeHierarchyIsInPages) {
  const fs::path source = write("scan.las", hills(6).text());
  const std::vector<CopcContentNode> nodes = exported(source).nodes();
  ExportOptions options = small_nodes();
  options.octree.page_entries = 12;
  const CopcContent copc = exported(source, options);
  EXPECT_GT(copc.pages(), 3U);
  EXPECT_EQ(copc.nodes(), nodes);
}

TEST_F(CopcTest, BytesDependOnNeitherMemoryNorThreadsNorTheOrderOfThePoints) {
  LasFile file = hills(7);
  const fs::path source = write("scan.las", file.text());
  const std::string expected = exported(source).text();
  for (const uint64_t memory : {uint64_t{1} << 12, uint64_t{1} << 16, uint64_t{1} << 19}) {
    ExportOptions options = small_nodes();
    options.octree.memory = memory;
    EXPECT_EQ(exported(source, options).text(), expected) << memory;
  }
  tbb::task_arena(1).execute([&] { EXPECT_EQ(exported(source).text(), expected); });
  std::ranges::reverse(file.records);
  EXPECT_EQ(exported(write("reversed.las", file.text())).text(), expected);
}

TEST_F(CopcTest, ADenseSpotInAWideScanFitsIntoLittleMemory) {
  LasFile file = hills(6, 3000);
  for (const auto& [x, y, z] : {std::array{2000000000, 0, 0}, {-2000000000, 5, 2000000000}})
    file.records.push_back(file.record(x, y, z).text());
  const fs::path source = write("scan.las", file.text());
  const CopcContent whole = exported(source);
  expect_octree(whole);
  EXPECT_GT(whole.nodes().back().level, 10);
  EXPECT_EQ(whole.records(), sorted(file.records));
  ExportOptions options = small_nodes();
  options.octree.memory = 1 << 14;
  EXPECT_EQ(exported(source, options).text(), whole.text());
}

TEST_F(CopcTest, TheRootIsAnEvenSampleOfTheSpacingThatIsStated) {
  const LasFile file = hills(6, 30000);
  ExportOptions options;
  options.encoding.chunk_size = 2000;
  const CopcContent copc = exported(write("scan.las", file.text()), options);
  std::vector<glm::dvec3> root;
  for (const std::string& record : copc.nodes().front().records) root.push_back(copc.position(record));
  ASSERT_GT(root.size(), 1000U);
  double least = INFINITY, farthest = 0;
  for (size_t i = 0; i < root.size(); ++i) {
    for (size_t j = 0; j < i; ++j) least = std::min(least, glm::distance(root[i], root[j]));
  }
  for (size_t i = 0; i < file.records.size(); i += 30) {
    double nearest = INFINITY;
    for (const glm::dvec3& point : root)
      nearest = std::min(nearest, glm::distance(point, copc.position(file.records[i])));
    farthest = std::max(farthest, nearest);
  }
  EXPECT_GE(least, 0.99999 * copc.spacing());
  EXPECT_LE(farthest, 2 * copc.spacing());
}

TEST_F(CopcTest, AZoneReadsWhatAFilterTakes) {
  const LasFile file = hills(6);
  const CopcContent copc = exported(write("scan.las", file.text()));
  const geometry::Box box{{4.5e6 + 20, 30, -20}, {4.5e6 + 60, 70, 5}};
  std::vector<std::string> expected;
  for (const std::string& record : file.records) {
    const glm::dvec3 p = copc.position(record);
    if (glm::min(glm::max(p, box.min), box.max) == p) expected.push_back(record);
  }
  ASSERT_GT(expected.size(), 200U);
  ExportOptions options = small_nodes();
  options.selection.zone.boxes.push_back(box);
  fs::rename(place("out.copc.laz"), place("in.copc.laz"));
  EXPECT_EQ(exported(place("in.copc.laz"), options).records(), sorted(expected));
}

TEST_F(CopcTest, NodesMayBeOfAFewPoints) {
  const LasFile file = hills(6, 2000);
  ExportOptions options;
  options.encoding.chunk_size = 1;
  const CopcContent copc = exported(write("scan.las", file.text()), options);
  EXPECT_EQ(copc.records(), sorted(file.records));
  expect_octree(copc);
}

TEST_F(CopcTest, CellsAreDividedDownToTheLeavesOfTheOptionsWithoutAChunkSize) {
  const uint64_t leaf = OctreeOptions().leaf_points;
  const CopcContent one = exported(write("one.las", hills(6, leaf).text()), {});
  EXPECT_EQ(one.nodes().size(), 1U);
  const CopcContent more = exported(write("more.las", hills(6, leaf + 1).text()), {});
  EXPECT_GT(more.nodes().size(), 1U);
}

TEST_F(CopcTest, ScalesMayBeNegative) {
  LasFile file = hills(6, 2000);
  file.scale[0] = -0.01;
  const CopcContent copc = exported(write("scan.las", file.text()));
  EXPECT_EQ(copc.records(), sorted(file.records));
  expect_octree(copc);
}

TEST_F(CopcTest, OnePointIsAScan) {
  const LasFile file = hills(7, 1);
  const CopcContent copc = exported(write("scan.las", file.text()));
  ASSERT_EQ(copc.nodes().size(), 1U);
  EXPECT_EQ(copc.records(), file.records);
  EXPECT_GT(copc.half(), 0);
  expect_octree(copc);
}

TEST_F(CopcTest, PointsInOnePlaceAreOneNode) {
  LasFile file = hills(6, 1000);
  for (std::string& record : file.records) record.replace(0, 12, file.records[0], 0, 12);
  const fs::path source = write("scan.las", file.text());
  const CopcContent copc = exported(source);
  EXPECT_EQ(copc.nodes().size(), 1U);
  EXPECT_EQ(copc.records(), sorted(file.records));
  ExportOptions options = small_nodes();
  options.octree.memory = 1 << 12;
  EXPECT_EQ(exported(source, options).text(), copc.text());
}

TEST_F(CopcTest, AHeapOfPointsAmongOthersIsKeptWhole) {
  LasFile file = hills(6, 3000);
  for (size_t i = 500; i < 1500; ++i) file.records[i].replace(0, 12, file.records[500], 0, 12);
  const CopcContent copc = exported(write("scan.las", file.text()));
  EXPECT_EQ(copc.records(), sorted(file.records));
  expect_octree(copc);
}

TEST_F(CopcTest, AnyScanBecomesOne) {
  const fs::path source = write("scan.csv",
                                "x,y,z,nx,ny,nz,red,green,blue,intensity,quality\n"
                                "1000.125,2000.5,-3.25,0,0,1,255,0,7,500,-1.5\n"
                                "1001.25,2001.75,-4.5,1,0,0,1,2,3,65535,2.25\n");
  const CopcContent copc = exported(source);
  EXPECT_EQ(copc.header().point_format, 7);
  const auto out = testing::whole(scan::ScanStream::open(place("out.copc.laz")));
  ASSERT_TRUE(out) << out.error().message;
  EXPECT_THAT(out->positions,
              ::testing::UnorderedElementsAre(glm::dvec3(1000.125, 2000.5, -3.25), glm::dvec3(1001.25, 2001.75, -4.5)));
  EXPECT_THAT(testing::scalar_values<double>(*out, "quality"), ::testing::UnorderedElementsAre(-1.5, 2.25));
  EXPECT_THAT(testing::scalar_values<uint16_t>(*out, "intensity"), ::testing::UnorderedElementsAre(500, 65535));
  EXPECT_EQ(out->normals.size(), 2U);
}

TEST_F(CopcTest, NothingIsLeftBesideTheFile) {
  ExportOptions options = small_nodes();
  options.octree.memory = 1 << 14;
  exported(write("scan.las", hills(6).text()), options);
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_->path())) names.insert(entry.path().filename());
  EXPECT_THAT(names, ::testing::ElementsAre("out.copc.laz", "scan.las"));
}

}  // namespace
}  // namespace surfcast::exporter
