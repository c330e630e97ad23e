#include <random>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "builder/build_model.h"
#include "builder/gaussian_sample.h"
#include "builder/kind_trees.h"
#include "gaussian/gaussian_block.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "gaussian/merge_gaussians.h"
#include "model/test_folder.h"
#include "support/file_content.h"

namespace surfcast::builder {
namespace {

using testing::ModelPointer;

/// Gaussians of a sphere and within it, more than a block holds.
reference::GaussianModel many(int count) {
  std::mt19937 random(3);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  reference::GaussianModel model{{}, 1};
  for (int i = 0; i < count; ++i) {
    reference::GaussianSplat splat;
    splat.position = {uniform(-1, 1), uniform(-1, 1), 0.1 * uniform(-1, 1)};
    splat.log_scale = {uniform(-6, -5), uniform(-6, -5), uniform(-9, -5)};
    splat.rotation = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    splat.logit = uniform(-3, 3);
    for (int k = 0; k < 4; ++k) splat.harmonics.at(k) = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    model.splats.push_back(splat);
  }
  return model;
}

gaussian::Gaussians columns_of(const reference::GaussianModel& model) {
  gaussian::Gaussians gaussians;
  for (const reference::GaussianSplat& splat : model.splats) {
    gaussians.positions.push_back(splat.position);
    gaussians.scales.emplace_back(0.01F);
    gaussians.rotations.emplace_back(1, 0, 0, 0);
    gaussians.opacities.push_back(0.5F);
    for (int c = 0; c < 3; ++c) gaussians.harmonics.push_back(static_cast<float>(splat.harmonics[0][c]));
  }
  return gaussians;
}

TEST(GaussianSorterTest, TheOrderDoesNotDependOnTheMemory) {
  const model::TestFolder folder;
  const gaussian::Gaussians all = columns_of(many(5000));
  const geometry::RootCube root = geometry::root_cube({{-1, -1, -1}, {1, 1, 1}});
  std::vector<std::vector<glm::dvec3>> orders;
  for (const uint64_t bytes : {uint64_t{1} << 30, uint64_t{40000}, uint64_t{9000}}) {
    GaussianSorter sorter(folder / "target", root, 0, bytes);
    ASSERT_TRUE(sorter.add(all));
    ASSERT_TRUE(sorter.finish());
    std::vector<glm::dvec3> order;
    while (true) {
      const Result<std::optional<uint64_t>> next = sorter.code(0);
      ASSERT_TRUE(next);
      if (!*next) break;
      const Result<gaussian::Gaussians> one = sorter.take(1);
      ASSERT_TRUE(one);
      EXPECT_EQ(geometry::morton_code(root, one->positions[0]), **next);
      order.push_back(one->positions[0]);
    }
    orders.push_back(order);
  }
  EXPECT_EQ(orders[0].size(), 5000U);
  EXPECT_EQ(orders[1], orders[0]);
  EXPECT_EQ(orders[2], orders[0]);
}

TEST(BuildGaussiansTest, BlocksMakeAnOctreeThatHoldsEveryGaussianOnce) {
  const model::TestFolder folder;
  const ModelPointer model =
      testing::build_and_open(testing::write_ply(folder / "many.ply", many(40000)), folder / "many.surf");
  ASSERT_TRUE(model);
  EXPECT_EQ(model->info().kinds.size(), 1U);
  EXPECT_EQ(model->info().kinds[0].kind, "gaussian");
  EXPECT_EQ(model->info().kinds[0].items, 40000U);
  EXPECT_EQ(model->info().harmonics_degree, 1);
  EXPECT_EQ(model->info().up(), glm::dvec3(0, -1, 0));
  EXPECT_GT(model->info().levels, 1);
  for (uint32_t i = 0; i < model->blocks().size(); ++i) {
    const ldc::BlockEntry& block = model->blocks()[i];
    EXPECT_LE(block.items, 16384U);
    if (block.parent == ldc::BlockEntry::kNoParent) continue;
    EXPECT_GT(model->blocks()[block.parent].spacing, block.spacing);
  }
}

TEST(BuildGaussiansTest, TheFileDependsNeitherOnThreadsNorOnMemory) {
  const model::TestFolder folder;
  const std::filesystem::path ply = testing::write_ply(folder / "many.ply", many(40000));
  ASSERT_TRUE(testing::build_and_open(ply, folder / "expected.surf"));
  {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    ASSERT_TRUE(testing::build_and_open(ply, folder / "one.surf"));
  }
  ASSERT_TRUE(testing::build_and_open(ply, folder / "little.surf", uint64_t{4} << 20));
  EXPECT_EQ(testing::file_content(folder / "one.surf"), testing::file_content(folder / "expected.surf"));
  EXPECT_EQ(testing::file_content(folder / "little.surf"), testing::file_content(folder / "expected.surf"));
}

TEST(BuildGaussiansTest, APreviewHasAWidenedSampleFromAllPartsOfTheInput) {
  const model::TestFolder folder;
  const std::filesystem::path ply = testing::write_ply(folder / "many.ply", many(40000));
  BuildOptions options;
  options.sample = 1000;
  const auto report = build_model(std::vector{ply}, folder / "preview.surf", options, [](const BuildStep&) {});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->gaussians, 1000U);
  EXPECT_EQ(report->points_in_scans, 40000U);
  options.sample = 50000;
  const auto whole = build_model(std::vector{ply}, folder / "whole.surf", options, [](const BuildStep&) {});
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->gaussians, 40000U);
}

TEST(GaussianSampleTest, DoesNotDependOnTheRunsAndKeepsTheAreaOfAll) {
  const gaussian::Gaussians all = columns_of(many(5000));
  std::vector<glm::dvec3> expected;
  for (const size_t length : {5000, 700, 1}) {
    GaussianSample sample(5000, 50);
    std::vector<glm::dvec3> kept;
    for (size_t first = 0; first < all.size(); first += length) {
      gaussian::Gaussians run;
      for (size_t i = first; i < std::min(all.size(), first + length); ++i) gaussian::append(all, i, run);
      sample.thin(run);
      kept.insert(kept.end(), run.positions.begin(), run.positions.end());
      for (const glm::vec3& scale : run.scales) EXPECT_NEAR(scale.x, 0.1F, 1e-6F) << "a hundredth times sqrt(100)";
    }
    EXPECT_EQ(kept.size(), 50U);
    if (expected.empty()) expected = kept;
    EXPECT_EQ(kept, expected);
  }
}

TEST(BuildGaussiansTest, CoincidentGaussiansFillSeveralBlocks) {
  const model::TestFolder folder;
  reference::GaussianModel model = many(40000);
  for (reference::GaussianSplat& splat : model.splats) splat.position = {1, 2, 3};
  model.splats.front().position = {5, 2, 3};
  const ModelPointer built =
      testing::build_and_open(testing::write_ply(folder / "one.ply", model), folder / "one.surf");
  ASSERT_TRUE(built);
  EXPECT_EQ(built->info().kinds[0].items, 40000U);
}

TEST(BuildGaussiansTest, WhatCannotBeOneModelIsRefused) {
  const model::TestFolder folder;
  const std::filesystem::path solid = testing::write_ply(folder / "solid.ply", many(10));
  const std::filesystem::path discs = testing::write_ply(folder / "discs.ply", many(10), true);
  const auto build = [&](const std::vector<std::filesystem::path>& inputs) {
    const auto report = build_model(inputs, folder / "both.surf", {}, [](const BuildStep&) {});
    return report ? std::string() : report.error().message;
  };
  EXPECT_EQ(build({solid, solid}), "");
  EXPECT_EQ(build({solid, discs}),
            discs.string() + ": is trained otherwise than " + solid.string() + ": build a model of each");
}

}  // namespace
}  // namespace surfcast::builder
