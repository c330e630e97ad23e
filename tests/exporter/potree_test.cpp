#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/scratch_folder.h"
#include "exporter/export_scan.h"
#include "octree_scans.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;
using testing::LasFile;

constexpr size_t kEntryBytes = 22;

std::string content(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

template <typename T>
T number_at(const std::string& bytes, size_t at) {
  T number{};
  std::memcpy(&number, &bytes.at(at + sizeof(T) - 1) - (sizeof(T) - 1), sizeof(T));
  return number;
}

/// A node as the loader of Potree 2 finds it (OctreeLoader.parseHierarchy).
struct LoadedNode {
  uint32_t points = 0;
  uint64_t offset = 0;
  uint64_t bytes = 0;
};
using LoadedNodes = std::map<std::string, LoadedNode>;

/// Reads a page as the loader does: nodes breadth first, children by the bits of a mask, links to other pages.
void load_page(const std::string& hierarchy, const std::string& top, uint64_t offset, uint64_t bytes,
               LoadedNodes& nodes, size_t& pages) {
  ++pages;
  ASSERT_EQ(bytes % kEntryBytes, 0U);
  std::deque<std::string> names{top};
  for (uint64_t at = offset; at < offset + bytes; at += kEntryBytes) {
    ASSERT_FALSE(names.empty()) << "more entries than the masks announce";
    const std::string name = names.front();
    names.pop_front();
    const auto type = number_at<uint8_t>(hierarchy, at);
    const auto mask = number_at<uint8_t>(hierarchy, at + 1);
    const LoadedNode node{number_at<uint32_t>(hierarchy, at + 2), number_at<uint64_t>(hierarchy, at + 6),
                          number_at<uint64_t>(hierarchy, at + 14)};
    if (type == 2) {
      ASSERT_NE(name, top);
      load_page(hierarchy, name, node.offset, node.bytes, nodes, pages);
      EXPECT_EQ(nodes[name].points, node.points);
      continue;
    }
    EXPECT_EQ(type, mask == 0 ? 1 : 0) << name;
    nodes[name] = node;
    for (int child = 0; child < 8; ++child) {
      if (mask >> child & 1) names.push_back(name + static_cast<char>('0' + child));
    }
  }
  EXPECT_TRUE(names.empty()) << "a mask announces nodes that are not there";
}

class PotreeTest : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_->path() / name, std::ios::binary) << text;
    return folder_->path() / name;
  }
  [[nodiscard]] fs::path place(const std::string& name) const { return folder_->path() / name; }
  /// The description; the nodes, and how many pages they are in.
  Json load(const std::string& name, LoadedNodes& nodes, size_t& pages) const {
    Json metadata = Json::parse(content(place(name + "/metadata.json")), nullptr, false);
    load_page(content(place(name + "/hierarchy.bin")), "r", 0, metadata["hierarchy"]["firstChunkSize"], nodes, pages);
    return metadata;
  }
  /// The lines of a scan as CSV, sorted.
  [[nodiscard]] std::vector<std::string> lines_of(const std::string& scan) const {
    const auto report = export_scan(place(scan), place("lines.csv"), {});
    EXPECT_TRUE(report) << report.error().message;
    std::ifstream in(place("lines.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    std::ranges::sort(lines);
    return lines;
  }

  Result<ScratchFolder> folder_ = ScratchFolder::create(fs::temp_directory_path(), "potree-test-");
};

TEST_F(PotreeTest, EveryPointIsInTheCubeOfItsNodeOnce) {
  const LasFile file = hills(7);
  const auto report = export_scan(write("scan.las", file.text()), place("out/metadata.json"), few_points_a_node());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->points, 6000U);
  LoadedNodes nodes;
  size_t pages = 0;
  const Json metadata = load("out", nodes, pages);
  EXPECT_EQ(pages, 1U);
  EXPECT_GT(nodes.size(), 30U);
  size_t stride = 0;
  for (const Json& attribute : metadata["attributes"]) stride += attribute["size"].get<size_t>();
  const std::string points = content(place("out/octree.bin"));
  const auto low = metadata["boundingBox"]["min"].get<std::vector<double>>(),
             high = metadata["boundingBox"]["max"].get<std::vector<double>>();
  std::vector<std::string> all;
  for (const auto& [name, node] : nodes) {
    ASSERT_EQ(node.bytes, node.points * stride) << name;
    std::array<double, 3> corner{low[0], low[1], low[2]};
    double side = high[0] - low[0];
    for (const char digit : name.substr(1)) {
      side /= 2;
      for (size_t axis = 0; axis < 3; ++axis) corner[axis] += ((digit - '0') >> (2 - axis) & 1) * side;
    }
    for (uint64_t at = node.offset; at < node.offset + node.bytes; at += stride) {
      for (size_t axis = 0; axis < 3; ++axis) {
        const double offset = number_at<int32_t>(points, at + 4 * axis) * metadata["scale"][axis].get<double>() +
                              metadata["offset"][axis].get<double>() - corner[axis];
        EXPECT_GE(offset, -1e-8) << name;
        EXPECT_LE(offset, side + 1e-8) << name;
      }
      all.push_back(points.substr(at, 12));
    }
  }
  std::vector<std::string> expected;
  for (const std::string& record : file.records) expected.push_back(record.substr(0, 12));
  std::ranges::sort(expected);
  std::ranges::sort(all);
  EXPECT_EQ(all, expected);
}

TEST_F(PotreeTest, TheDescriptionStatesPointsBoundsAndAttributes) {
  const LasFile file = hills_with_quality(8);
  ASSERT_TRUE(export_scan(write("scan.las", file.text()), place("out/metadata.json"), few_points_a_node()));
  LoadedNodes nodes;
  size_t pages = 0;
  const Json metadata = load("out", nodes, pages);
  EXPECT_EQ(metadata["version"], "2.0");
  EXPECT_EQ(metadata["name"], "out");
  EXPECT_EQ(metadata["points"], 6000);
  EXPECT_EQ(metadata["encoding"], "DEFAULT");
  EXPECT_EQ(metadata["projection"], "PROJCS[\"somewhere\"]");
  EXPECT_EQ(metadata["offset"][0], 4.5e6);
  EXPECT_EQ(metadata["scale"][2], 0.002);
  const double side = metadata["boundingBox"]["max"][0].get<double>() - metadata["boundingBox"]["min"][0].get<double>();
  EXPECT_NEAR(metadata["spacing"].get<double>(), side / 128, 1e-9 * side);
  size_t depth = 0;
  for (const auto& [name, node] : nodes) depth = std::max(depth, name.size() - 1);
  EXPECT_EQ(metadata["hierarchy"]["depth"], depth);
  std::map<std::string, Json> attributes;
  for (const Json& attribute : metadata["attributes"]) attributes[attribute["name"]] = attribute;
  EXPECT_EQ(metadata["attributes"][0]["name"], "position");
  EXPECT_EQ(attributes["position"]["type"], "int32");
  EXPECT_EQ(attributes["rgb"]["type"], "uint16");
  EXPECT_EQ(attributes["rgb"]["numElements"], 3);
  EXPECT_EQ(attributes["gps-time"]["type"], "double");
  EXPECT_EQ(attributes["return number"]["type"], "uint8");
  EXPECT_EQ(attributes["point source id"]["size"], 2);
  EXPECT_EQ(attributes["quality"]["type"], "uint16");
  int least = 65536, most = -1;
  double highest = -INFINITY;
  for (const std::string& record : file.records) {
    least = std::min<int>(least, number_at<uint16_t>(record, 12));
    most = std::max<int>(most, number_at<uint16_t>(record, 12));
    highest = std::max(highest, number_at<int32_t>(record, 8) * 0.002);
  }
  EXPECT_EQ(attributes["intensity"]["min"], Json::array({least}));
  EXPECT_EQ(attributes["intensity"]["max"], Json::array({most}));
  EXPECT_EQ(attributes["position"]["max"][2], highest);
}

TEST_F(PotreeTest, TheReaderGivesTheScanBack) {
  for (const int format : {6, 7, 8}) {
    fs::remove_all(place("out"));
    ASSERT_TRUE(
        export_scan(write("scan.las", hills(format, 3000).text()), place("out/metadata.json"), few_points_a_node()));
    const std::vector<std::string> lines = lines_of("out/metadata.json");
    EXPECT_EQ(lines.size(), 3001U);
    EXPECT_EQ(lines, lines_of("scan.las")) << format;
  }
}

TEST_F(PotreeTest, ALargeHierarchyIsInPages) {
  const fs::path source = write("scan.las", hills(6).text());
  ExportOptions options = few_points_a_node();
  ASSERT_TRUE(export_scan(source, place("whole/metadata.json"), options));
  options.octree.page_entries = 12;
  options.octree.memory = 1 << 14;
  ASSERT_TRUE(export_scan(source, place("paged/metadata.json"), options));
  LoadedNodes whole, paged;
  size_t pages = 0, one = 0;
  load("whole", whole, one);
  load("paged", paged, pages);
  EXPECT_EQ(one, 1U);
  EXPECT_GT(pages, 3U);
  ASSERT_EQ(paged.size(), whole.size());
  for (const auto& [name, node] : whole) EXPECT_EQ(paged[name].points, node.points) << name;
  EXPECT_EQ(lines_of("paged/metadata.json"), lines_of("whole/metadata.json"));
}

TEST_F(PotreeTest, FailuresLeaveNothing) {
  const fs::path source = write("scan.las", hills(6, 100).text());
  ExportOptions options;
  options.selection.zone.boxes.push_back({glm::dvec3(-2e9), glm::dvec3(-1e9)});
  const auto report = export_scan(source, place("out/metadata.json"), options);
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("has no points in the selection"));
  fs::create_directory(place("full"));
  write("full/mine.txt", "mine");
  const auto full = export_scan(source, place("full/metadata.json"), {});
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().message,
            place("full/metadata.json").string() + ": name a new folder for it, like scan/metadata.json");
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_->path())) names.insert(entry.path().filename());
  EXPECT_THAT(names, ElementsAre("full", "scan.las"));
}

}  // namespace
}  // namespace surfcast::exporter
