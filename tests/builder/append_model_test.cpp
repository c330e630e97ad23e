#include "builder/append_model.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "builder/model_surfels.h"
#include "builder/text_scan.h"
#include "model/model_file.h"
#include "model/test_folder.h"
#include "support/file_content.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::set<uint64_t> checksums_of(const fs::path& path, bool leaves) {
  std::set<uint64_t> checksums;
  const Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model) << model.error().message;
  for (const ldc::BlockEntry& block : model->blocks()) {
    if ((block.level == 0) == leaves) checksums.insert(block.checksum);
  }
  return checksums;
}

/// Hills of side by side points, some of them.
std::vector<glm::dvec3> hills(double from, double to, double side) {
  std::vector<glm::dvec3> positions;
  for (double x = from; x < to; x += 1) {
    for (double y = 0; y < side; y += 1) {
      const glm::dvec3 p(x + 0.3 * std::sin(12.9 * x + 78.2 * y), y + 0.3 * std::sin(39.3 * x + 11.1 * y), 0);
      positions.push_back(p + glm::dvec3(0, 0, 4 * std::sin(p.x / 15) * std::cos(p.y / 19)));
    }
  }
  return positions;
}

class AppendModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write("west.xyz", hills(0, 360, 200), 0);
    write("east.xyz", hills(360, 400, 200), 72000);
    build({west_}, model_);
  }

  fs::path write(const std::string& name, const std::vector<glm::dvec3>& positions, size_t first) const {
    const fs::path path = folder_ / name.c_str();
    numbered(positions, first).write(path);
    return path;
  }
  static void build(const std::vector<fs::path>& inputs, const fs::path& target) {
    const Result<BuildReport> report = build_model(inputs, target, {}, [](const BuildStep&) {});
    ASSERT_TRUE(report) << report.error().message;
  }
  BuildReport append(const std::vector<fs::path>& inputs, const AppendOptions& options = {}) const {
    const Result<BuildReport> report = append_to_model(inputs, model_, options, [](const BuildStep&) {});
    EXPECT_TRUE(report) << report.error().message;
    return report.value_or(BuildReport{});
  }
  /// The error of an attempt that must fail, and must leave the model and nothing else.
  [[nodiscard]] std::string refused(const fs::path& input) const {
    const std::string before = testing::file_content(model_);
    const Result<BuildReport> report = append_to_model(std::vector{input}, model_, {}, [](const BuildStep&) {});
    EXPECT_FALSE(report);
    EXPECT_EQ(testing::file_content(model_), before);
    return report ? "" : report.error().message;
  }
  /// Compares the model with that of all inputs.
  void expect_like_build_of(const std::vector<fs::path>& inputs) const {
    build(inputs, whole_);
    const std::map<uint32_t, Surfel> expected = surfels_of(whole_);
    const std::map<uint32_t, Surfel> points = surfels_of(model_);
    ASSERT_EQ(points.size(), expected.size());
    size_t turned = 0;
    size_t resized = 0;
    size_t reweighted = 0;
    for (const auto& [number, point] : points) {
      const Surfel& other = expected.at(number);
      EXPECT_LT(glm::distance(point.position, other.position), 2 * other.radius / 256);
      EXPECT_EQ(point.intensity, other.intensity);
      turned += glm::dot(point.normal, other.normal) < 0.999F ? 1 : 0;
      resized += std::abs(point.radius / other.radius - 1) > 0.05F ? 1 : 0;
      reweighted += std::abs(point.weight / other.weight - 1) > 0.1F ? 1 : 0;
    }
    EXPECT_LT(turned, points.size() / 2000);
    EXPECT_LT(resized, points.size() / 2000);
    EXPECT_LT(reweighted, points.size() / 2000);
  }

  model::TestFolder folder_;
  fs::path west_ = folder_ / "west.xyz";
  fs::path east_ = folder_ / "east.xyz";
  fs::path model_ = folder_ / "model.surf";
  fs::path whole_ = folder_ / "whole.surf";
};

TEST_F(AppendModelTest, TheModelIsLikeThatOfAllScans) {
  const BuildReport report = append({east_});
  EXPECT_EQ(report.scan.points_read, 8000U);
  EXPECT_EQ(report.surfels, 80000U);
  ASSERT_TRUE(report.appended);
  EXPECT_EQ(report.appended->surfels_before, 72000U);
  expect_like_build_of({west_, east_});
}

TEST_F(AppendModelTest, BlocksThatAreFarAwayStayByteForByte) {
  const std::set<uint64_t> before = checksums_of(model_, true);
  const BuildReport report = append({east_});
  const std::set<uint64_t> after = checksums_of(model_, true);
  std::vector<uint64_t> same;
  std::ranges::set_intersection(before, after, std::back_inserter(same));
  EXPECT_GE(same.size(), before.size() / 2);
  EXPECT_GE(report.appended->blocks_copied, same.size());
  EXPECT_LT(same.size(), before.size());
}

TEST_F(AppendModelTest, TheTablesAreThoseOfAllScans) {
  append({east_});
  build({west_, east_}, whole_);
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  const Result<model::ModelFile> whole = model::ModelFile::open(whole_);
  ASSERT_TRUE(model && whole);
  EXPECT_THAT(model->info().source_names, ElementsAre("west.xyz", "east.xyz"));
  EXPECT_EQ(model->info().scalar_names, whole->info().scalar_names);
  EXPECT_EQ(model->info().oriented, whole->info().oriented);
  ASSERT_EQ(model->info().ranges.size(), whole->info().ranges.size());
  for (size_t i = 0; i < whole->info().ranges.size(); ++i) {
    const model::AttributeRange& range = model->info().ranges[i];
    const model::AttributeRange& other = whole->info().ranges[i];
    EXPECT_EQ(range.attribute, other.attribute);
    EXPECT_EQ(range.smallest, other.smallest);
    EXPECT_EQ(range.largest, other.largest);
    EXPECT_NEAR(range.low, other.low, 0.02 * (other.largest - other.smallest));
    EXPECT_NEAR(range.high, other.high, 0.02 * (other.largest - other.smallest));
  }
}

TEST_F(AppendModelTest, MoreIsAddedAfterwards) {
  const fs::path far = write("far.xyz", hills(400, 520, 200), 80000);
  append({east_});
  append({far});
  expect_like_build_of({west_, east_, far});
}

TEST_F(AppendModelTest, SeveralScansAreAddedAtOnce) {
  const fs::path far = write("far.xyz", hills(400, 430, 200), 80000);
  append({east_, far});
  expect_like_build_of({west_, east_, far});
}

TEST_F(AppendModelTest, TheCubeGrowsBelowItsCorner) {
  const fs::path below = write("below.xyz", hills(-300, 0, 200), 100000);
  const BuildReport report = append({below});
  EXPECT_GT(report.appended->blocks_copied, 0U);
  expect_like_build_of({west_, below});
  append({east_});
  expect_like_build_of({west_, below, east_});
}

TEST_F(AppendModelTest, SmallRegionsMakeTheSamePoints) {
  const fs::path far = write("far.xyz", hills(360, 700, 200), 80000);
  AppendOptions options;
  options.part_points = 5000;
  const BuildReport report = append({far}, options);
  EXPECT_GT(report.parts, 8U);
  expect_like_build_of({west_, far});
}

TEST_F(AppendModelTest, PointsBetweenThoseOfTheModelAreAdded) {
  std::vector<glm::dvec3> between = hills(100, 140, 60);
  for (glm::dvec3& p : between) p += glm::dvec3(0.5, 0.5, 0.02);
  const fs::path dense = write("dense.xyz", between, 90000);
  append({dense});
  expect_like_build_of({west_, dense});
}

TEST_F(AppendModelTest, AModelOfOneBlockGrows) {
  const fs::path few = write("few.xyz", hills(0, 30, 30), 0);
  const fs::path more = write("more.xyz", hills(30, 300, 200), 1000);
  build({few}, model_);
  append({more});
  expect_like_build_of({few, more});
}

TEST_F(AppendModelTest, ASmallMemoryMakesTheSameBytes) {
  const fs::path far = write("far.xyz", hills(360, 700, 200), 80000);
  const std::string before = testing::file_content(model_);
  AppendOptions options;
  options.part_points = 5000;
  append({far}, options);
  const std::string with_all = testing::file_content(model_);
  std::ofstream(model_, std::ios::binary) << before;
  options.memory = uint64_t{400} << 20;
  const BuildReport report = append({far}, options);
  EXPECT_EQ(report.memory_budget, uint64_t{400} << 20);
  EXPECT_TRUE(testing::file_content(model_) == with_all);
}

/// At this latitude zones 32 and 33 meet where eastings are 720.6 km in one and 279.4 km in the other.
TEST_F(AppendModelTest, AScanInAnotherSystemIsBroughtIntoThatOfTheModel) {
  const auto in_zone = [this](const std::string& name, double from, double to, double zone, size_t first) {
    std::vector<glm::dvec3> positions = hills(from, to, 100);
    for (glm::dvec3& p : positions) p += glm::dvec3(zone, 5'400'000, 200);
    return write(name, positions, first);
  };
  const fs::path west = in_zone("zone32.xyz", 0, 200, 720'000, 0);
  const fs::path east = in_zone("more.xyz", 200, 260, 720'000, 50000);
  BuildOptions build_options;
  build_options.systems.assigned = "EPSG:25832";
  ASSERT_TRUE(build_model(std::vector{west}, model_, build_options, [](const BuildStep&) {}));
  AppendOptions options;
  options.systems.assigned = "EPSG:25832";
  append({east}, options);
  ASSERT_TRUE(build_model(std::vector{west, east}, whole_, build_options, [](const BuildStep&) {}));
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  ASSERT_TRUE(model);
  const Result<model::Georeference> georeference = model->georeference();
  ASSERT_TRUE(georeference);
  EXPECT_EQ(georeference->system.id, "EPSG:25832");
  const std::map<uint32_t, Surfel> expected = surfels_of(whole_);
  const std::map<uint32_t, Surfel> points = surfels_of(model_);
  ASSERT_EQ(points.size(), expected.size());
  for (const auto& [number, point] : points) {
    EXPECT_LT(glm::distance(point.position, expected.at(number).position), 2 * point.radius / 256);
  }
  options.systems.assigned = "EPSG:25833";
  const fs::path other = in_zone("zone33.xyz", 260, 300, 280'000, 60000);
  const BuildReport report = append({other}, options);
  ASSERT_EQ(report.transformed.size(), 1U);
  const Result<model::ModelFile> grown = model::ModelFile::open(model_);
  ASSERT_TRUE(grown);
  EXPECT_GT(grown->info().bounds.max.x, 720'260);
  EXPECT_LT(grown->info().bounds.max.x, 730'000);
}

TEST_F(AppendModelTest, WhatDoesNotFitIsRefusedByName) {
  const fs::path empty = folder_ / "empty.xyz";
  std::ofstream(empty) << "x y z number intensity\n";
  EXPECT_THAT(refused(empty), HasSubstr("empty.xyz"));
  EXPECT_THAT(refused(folder_ / "missing.xyz"), HasSubstr("missing.xyz"));
  const fs::path other = folder_ / "other.xyz";
  std::ofstream(other) << "x y z number intensity heat\n1 2 3 4 5 6\n2 3 4 5 6 7\n";
  EXPECT_THAT(refused(other), HasSubstr("other.xyz: has the attribute heat, which model.surf lacks"));
  const fs::path far = write("far.xyz", {{1e9, 0, 0}, {1e9, 1, 0}}, 0);
  EXPECT_THAT(refused(far), HasSubstr("far.xyz: is too far away from model.surf"));
  const fs::path grid = folder_ / "grid.nrrd";
  std::ofstream(grid) << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n12345678";
  EXPECT_THAT(refused(grid), HasSubstr("grid.nrrd: only scans can be added"));
}

TEST_F(AppendModelTest, OtherModelsAreRefused) {
  const fs::path grid = folder_ / "grid.nrrd";
  std::ofstream(grid) << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n12345678";
  build({grid}, model_);
  EXPECT_THAT(refused(east_), HasSubstr("model.surf: cannot be added to, because it holds more than surfels"));
  std::ofstream(model_) << "no model";
  EXPECT_THAT(refused(east_), HasSubstr("model.surf"));
}

}  // namespace
}  // namespace surfcast::builder
