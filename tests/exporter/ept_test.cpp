#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/scratch_folder.h"
#include "exporter/export_scan.h"
#include "octree_scans.h"
#include "scan/las_records.h"
#include "scan/whole_scan.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;
using testing::LasFile;

Json json_of(const fs::path& path) {
  std::ifstream in(path);
  return Json::parse(in, nullptr, false);
}

std::vector<std::string> records_of_tile(const fs::path& path) {
  const auto records = scan::LasRecords::open(path, {});
  EXPECT_TRUE(records) << records.error().message;
  std::vector<std::string> all;
  for (size_t piece = 0; records && piece < records->pieces(); ++piece) {
    const auto bytes = records->read(piece);
    EXPECT_TRUE(bytes) << bytes.error().message;
    const size_t length = records->header().record_length;
    for (size_t at = 0; at < bytes->size(); at += length)
      all.emplace_back(reinterpret_cast<const char*>(&(*bytes)[at]), length);
  }
  return all;
}

class EptTest : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& content) {
    std::ofstream(folder_->path() / name, std::ios::binary) << content;
    return folder_->path() / name;
  }
  [[nodiscard]] fs::path place(const std::string& name) const { return folder_->path() / name; }
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_->path())) names.insert(entry.path().filename());
    return names;
  }
  /// Counts of nodes by their names, through all pages.
  [[nodiscard]] std::map<std::string, int64_t> hierarchy(const std::string& ept, const std::string& page,
                                                         size_t& pages) const {
    ++pages;
    std::map<std::string, int64_t> counts;
    const Json json = json_of(place(ept + "/ept-hierarchy/" + page + ".json"));
    for (const auto& [name, count] : json.items()) {
      if (count != -1) counts[name] = count;
      if (count == -1) counts.merge(hierarchy(ept, name, pages));
    }
    return counts;
  }

  Result<ScratchFolder> folder_ = ScratchFolder::create(fs::temp_directory_path(), "ept-test-");
};

TEST_F(EptTest, EveryRecordIsInTheTileOfItsNode) {
  const LasFile file = hills(7);
  const auto report = export_scan(write("scan.las", file.text()), place("out/ept.json"), few_points_a_node());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->points, 6000U);
  size_t pages = 0;
  const std::map<std::string, int64_t> counts = hierarchy("out", "0-0-0-0", pages);
  EXPECT_EQ(pages, 1U);
  EXPECT_GT(counts.size(), 30U);
  const Json ept = json_of(place("out/ept.json"));
  const auto bounds = ept["bounds"].get<std::vector<double>>();
  std::vector<std::string> all;
  for (const auto& [name, count] : counts) {
    const std::vector<std::string> records = records_of_tile(place("out/ept-data/" + name + ".laz"));
    EXPECT_EQ(records.size(), static_cast<size_t>(count));
    int depth = 0;
    std::array<int, 3> cell{};
    ASSERT_EQ(std::sscanf(name.c_str(), "%d-%d-%d-%d", &depth, &cell[0], &cell[1], &cell[2]), 4);
    const double side = std::ldexp(bounds[3] - bounds[0], -depth);
    for (const std::string& record : records) {
      for (size_t axis = 0; axis < 3; ++axis) {
        const double at = scan::load<int32_t>(testing::as_bytes(record).data() + 4 * axis) * file.scale[axis] +
                          file.offset[axis] - bounds[axis] - cell[axis] * side;
        EXPECT_GE(at, -1e-8);
        EXPECT_LE(at, side + 1e-8);
      }
    }
    all.insert(all.end(), records.begin(), records.end());
  }
  std::vector<std::string> expected = file.records;
  std::ranges::sort(expected);
  std::ranges::sort(all);
  EXPECT_EQ(all, expected);
  EXPECT_THAT(names(), ElementsAre("out", "scan.las"));
}

TEST_F(EptTest, TheDescriptionStatesPointsBoundsAndDimensions) {
  const LasFile file = hills_with_quality(8);
  ASSERT_TRUE(export_scan(write("scan.las", file.text()), place("out/ept.json"), few_points_a_node()));
  const Json ept = json_of(place("out/ept.json"));
  EXPECT_EQ(ept["version"], "1.0.0");
  EXPECT_EQ(ept["dataType"], "laszip");
  EXPECT_EQ(ept["hierarchyType"], "json");
  EXPECT_EQ(ept["points"], 6000);
  EXPECT_EQ(ept["span"], 128);
  EXPECT_EQ(ept["srs"]["wkt"], "PROJCS[\"somewhere\"]");
  std::map<std::string, Json> dimensions;
  for (const Json& dimension : ept["schema"]) dimensions[dimension["name"]] = dimension;
  EXPECT_EQ(dimensions.size(), 3U + 16 + 1);
  EXPECT_EQ(dimensions["X"]["offset"], 4.5e6);
  EXPECT_EQ(dimensions["Z"]["scale"], 0.002);
  EXPECT_EQ(dimensions["Infrared"]["size"], 2);
  EXPECT_EQ(dimensions["GpsTime"]["type"], "float");
  EXPECT_EQ(dimensions["quality"]["size"], 2);
  EXPECT_EQ(dimensions["quality"]["type"], "unsigned");
  const auto bounds = ept["bounds"].get<std::vector<double>>(),
             tight = ept["boundsConforming"].get<std::vector<double>>();
  double highest = -INFINITY;
  for (const std::string& record : file.records)
    highest = std::max(highest, scan::load<int32_t>(testing::as_bytes(record).data() + 8) * 0.002);
  EXPECT_EQ(tight[5], highest);
  for (size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(bounds[3 + axis] - bounds[axis], bounds[3] - bounds[0], 1e-8);
    EXPECT_LE(bounds[axis], tight[axis]);
    EXPECT_GE(bounds[3 + axis], tight[3 + axis]);
  }
}

TEST_F(EptTest, TheReaderGivesTheScanBack) {
  const fs::path source = write("scan.las", hills(3, 3000).text());
  ASSERT_TRUE(export_scan(source, place("out/ept.json"), few_points_a_node()));
  ASSERT_TRUE(export_scan(source, place("out.copc.laz"), few_points_a_node()));
  for (const char* name : {"out/ept.json", "out.copc.laz"})
    ASSERT_TRUE(export_scan(place(name), place(std::string(name).substr(0, 5) + "table.csv"), {}));
  std::vector<std::vector<std::string>> tables;
  for (const char* name : {"out/etable.csv", "out.ctable.csv"}) {
    std::ifstream in(place(name));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    std::ranges::sort(lines);
    tables.push_back(std::move(lines));
  }
  EXPECT_EQ(tables[0].size(), 3001U);
  EXPECT_EQ(tables[0], tables[1]);
}

TEST_F(EptTest, ALargeHierarchyIsInPages) {
  const fs::path source = write("scan.las", hills(6).text());
  ExportOptions options = few_points_a_node();
  ASSERT_TRUE(export_scan(source, place("whole/ept.json"), options));
  options.octree.page_entries = 12;
  options.octree.memory = 1 << 14;
  ASSERT_TRUE(export_scan(source, place("paged/ept.json"), options));
  size_t pages = 0, one = 0;
  EXPECT_EQ(hierarchy("paged", "0-0-0-0", pages), hierarchy("whole", "0-0-0-0", one));
  EXPECT_GT(pages, 3U);
  const auto whole = testing::whole(scan::ScanStream::open(place("whole/ept.json")));
  const auto paged = testing::whole(scan::ScanStream::open(place("paged/ept.json")));
  ASSERT_TRUE(whole && paged);
  EXPECT_EQ(whole->positions, paged->positions);
}

TEST_F(EptTest, AFolderWithFilesIsLeftAsItIs) {
  const fs::path source = write("scan.las", hills(6, 100).text());
  fs::create_directory(place("out"));
  write("out/mine.txt", "mine");
  const auto report = export_scan(source, place("out/ept.json"), {});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().message, place("out/ept.json").string() + ": name a new folder for it, like scan/ept.json");
  EXPECT_EQ(std::distance(fs::directory_iterator(place("out")), fs::directory_iterator()), 1);
  fs::create_directory(place("empty"));
  EXPECT_TRUE(export_scan(source, place("empty/ept.json"), {}));
  EXPECT_TRUE(fs::exists(place("empty/ept-data/0-0-0-0.laz")));
}

TEST_F(EptTest, FailuresLeaveNothing) {
  const fs::path source = write("scan.las", hills(6, 100).text());
  ExportOptions options;
  options.selection.zone.boxes.push_back({glm::dvec3(-2e9), glm::dvec3(-1e9)});
  const auto report = export_scan(source, place("out/ept.json"), options);
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("has no points in the selection"));
  const auto nowhere = export_scan(source, place("none/out/ept.json"), {});
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, HasSubstr(place("none").string()));
  EXPECT_THAT(names(), ElementsAre("scan.las"));
}

}  // namespace
}  // namespace surfcast::exporter
