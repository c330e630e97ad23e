#include <fstream>
#include <functional>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "builder/build_model.h"
#include "builder/grid_input.h"
#include "isosurface/grid_of_field.h"
#include "isosurface/surface_inputs.h"
#include "model/model_file.h"
#include "model/test_folder.h"

namespace surfcast::isosurface {
namespace {

namespace fs = std::filesystem;

class SurfaceModelTest : public ::testing::Test {
 protected:
  builder::BuildReport build(const std::vector<fs::path>& inputs, const fs::path& target,
                             std::optional<uint64_t> part_points = {}) {
    SurfaceInputs surfaces({{0.5}}, target);
    builder::BuildOptions options;
    options.part_points = part_points;
    options.open = std::bind_front(&SurfaceInputs::open, &surfaces);
    const Result<builder::BuildReport> report =
        builder::build_model(inputs, target, options, [](const builder::BuildStep&) {});
    EXPECT_TRUE(report) << report.error().message;
    return report.value_or(builder::BuildReport{});
  }

  model::TestFolder folder_;
  fs::path grid_ = folder_ / "grid.nrrd";
  fs::path model_ = folder_ / "model.surf";
};

std::string content(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST_F(SurfaceModelTest, SurfelsAreOrientedDiscsOfTheStepsSize) {
  testing::write_grid(grid_, testing::soft_ball, {32, 32, 32}, testing::unit_cube(32));
  const builder::BuildReport report = build({grid_}, model_);
  EXPECT_EQ(report.scan.scatter, 0U);
  EXPECT_TRUE(report.scan.oriented);
  EXPECT_EQ(report.scan.normals_estimated, 0U);
  EXPECT_EQ(report.surfels, report.scan.points_read);
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  ASSERT_TRUE(model);
  const Result<model::DecodedBlock> block = model->decode(model->blocks().size() - 1);
  ASSERT_TRUE(block);
  for (const float radius : block->radii) {
    EXPECT_GT(radius, 0.7 * 2 / 31);
    EXPECT_LT(radius, 1.3 * 2 / 31);
  }
}

/// Balls of a few samples, far from each other.
double crumbs(const glm::dvec3& p) {
  const glm::dvec3 at = p - glm::round(p);
  return 1 - glm::length(at) / 0.3;
}

TEST_F(SurfaceModelTest, CrumbsOfASurfaceAreNotBlownUp) {
  testing::write_grid(grid_, crumbs, {21, 21, 21}, {{0.25, 0, 0}, {0, 0.25, 0}, {0, 0, 0.25}, {0, 0, 0}});
  build({grid_}, model_);
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  ASSERT_TRUE(model);
  for (const ldc::BlockEntry& block : model->blocks()) {
    if (block.level == 0) {
      EXPECT_LE(block.max_radius, 1.25F * 0.25F * 1.001F);
    }
  }
}

TEST_F(SurfaceModelTest, TheModelHasTheSameBytesForAnyNumberOfThreads) {
  testing::write_grid(grid_, testing::marschner_lobb, {41, 41, 41}, testing::unit_cube(41));
  const auto bytes_with = [&](size_t threads) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    build({grid_}, model_);
    return content(model_);
  };
  const std::string bytes = bytes_with(1);
  EXPECT_EQ(bytes_with(2), bytes);
  EXPECT_EQ(bytes_with(5), bytes);
}

TEST_F(SurfaceModelTest, SurfacesAreBuiltInPartsLikeScans) {
  testing::write_grid(grid_, testing::torus, {41, 41, 41}, testing::unit_cube(41));
  const builder::BuildReport report = build({grid_}, model_, 500);
  EXPECT_GT(report.parts, 3U);
  EXPECT_TRUE(report.scan.oriented);
  EXPECT_EQ(report.surfels, report.scan.points_read);
}

TEST_F(SurfaceModelTest, ScansAmongTheInputsStayScans) {
  testing::write_grid(grid_, testing::soft_ball, {16, 16, 16}, testing::unit_cube(16));
  const fs::path scan = folder_ / "scan.xyz";
  std::ofstream text(scan);
  for (int i = 0; i < 100; ++i) text << i % 10 * 0.1 << ' ' << i / 10 * 0.1 << " 2\n";
  text.close();
  const builder::BuildReport report = build({grid_, scan}, model_);
  EXPECT_EQ(report.scan.normals_estimated, 100U);
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  ASSERT_TRUE(model);
  EXPECT_THAT(model->info().source_names, ::testing::ElementsAre("grid.nrrd", "scan.xyz"));
  EXPECT_TRUE(builder::is_grid(grid_));
  EXPECT_FALSE(builder::is_grid(scan));
}

}  // namespace
}  // namespace surfcast::isosurface
