// Models of several kinds: each kind is what a model of it alone is.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "support/file_content.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using testing::ModelPointer;

/// A square of points with colours, more than a block holds.
fs::path write_scan(const fs::path& path) {
  std::string text;
  for (int y = 0; y < 150; ++y) {
    for (int x = 0; x < 150; ++x) {
      text += std::to_string(0.01 * x) + " " + std::to_string(0.01 * y) + " 7 200 100 50\n";
    }
  }
  return testing::write(path, text);
}

fs::path write_grid(const fs::path& path) {
  std::string text = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 20 10\nspacings: 1 1 1\nencoding: raw\n\n";
  for (int i = 0; i < 8000; ++i) text += static_cast<char>(i % 200);
  return testing::write(path, text);
}

fs::path write_splats(const fs::path& path) {
  reference::GaussianModel model{{}, 1};
  for (int i = 0; i < 20000; ++i) {
    reference::GaussianSplat splat;
    splat.position = {0.01 * (i % 100), 0.01 * (i / 100 % 100), -0.5 * (i / 10000)};
    splat.log_scale = glm::dvec3(-5);
    splat.harmonics[0] = {0.3, 0.1, -0.2};
    model.splats.push_back(splat);
  }
  return testing::write_ply(path, model);
}

ModelPointer build(const std::vector<fs::path>& inputs, const fs::path& target) {
  const Result<BuildReport> report = build_model(inputs, target, {}, [](const BuildStep&) {});
  EXPECT_TRUE(report) << (report ? "" : report.error().message);
  Result<model::ModelFile> model = model::ModelFile::open(target);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return report && model ? std::make_shared<const model::ModelFile>(std::move(*model)) : nullptr;
}

uint32_t number_of(const ModelPointer& model, std::string_view kind) {
  const auto& kinds = model->info().kinds;
  return static_cast<uint32_t>(std::ranges::find(kinds, kind, &model::KindCount::kind) - kinds.begin());
}

/// The stored bytes of the blocks of a kind, in the order of the tree, with their levels and bounds.
struct BlockContent {
  int level = 0;
  geometry::Box bounds;
  std::vector<std::byte> bytes;
  bool operator==(const BlockContent& other) const {
    return level == other.level && bounds.min == other.bounds.min && bounds.max == other.bounds.max &&
           bytes == other.bytes;
  }
};

std::vector<BlockContent> blocks_of(const ModelPointer& model, std::string_view kind) {
  const uint32_t number = number_of(model, kind);
  std::vector<BlockContent> blocks;
  for (size_t i = 0; i < model->blocks().size(); ++i) {
    const ldc::BlockEntry& entry = model->blocks()[i];
    if (entry.kind != number) continue;
    const auto stored = model->stored(i);
    EXPECT_TRUE(stored);
    blocks.push_back({entry.level, entry.bounds, {stored->bytes.begin(), stored->bytes.end()}});
  }
  return blocks;
}

class MixedBuildTest : public ::testing::Test {
 protected:
  model::TestFolder folder_;
  fs::path scan_ = write_scan(folder_ / "scan.xyz");
  fs::path grid_ = write_grid(folder_ / "grid.nrrd");
  fs::path splats_ = write_splats(folder_ / "splats.ply");
};

TEST_F(MixedBuildTest, EveryKindHasTheBlocksOfAModelOfItAlone) {
  const ModelPointer mixed = build({splats_, scan_, grid_}, folder_ / "mixed.surf");
  ASSERT_TRUE(mixed);
  const ModelPointer scan = build({scan_}, folder_ / "scan.surf");
  const ModelPointer grid = build({grid_}, folder_ / "grid.surf");
  const ModelPointer splats = build({splats_}, folder_ / "splats.surf");
  EXPECT_EQ(blocks_of(mixed, "surfel"), blocks_of(scan, "surfel"));
  EXPECT_EQ(blocks_of(mixed, "grid"), blocks_of(grid, "grid"));
  EXPECT_EQ(blocks_of(mixed, "gaussian"), blocks_of(splats, "gaussian"));
  EXPECT_EQ(mixed->blocks().size(), scan->blocks().size() + grid->blocks().size() + splats->blocks().size());
}

TEST_F(MixedBuildTest, TheTablesStateAllKindsAndSources) {
  const ModelPointer mixed = build({splats_, grid_, scan_}, folder_ / "mixed.surf");
  ASSERT_TRUE(mixed);
  const model::ModelInfo& info = mixed->info();
  EXPECT_EQ(info.source_names, (std::vector<std::string>{"scan.xyz", "grid.nrrd", "splats.ply"}));
  EXPECT_EQ(info.kinds.at(number_of(mixed, "surfel")).items, 22500U);
  EXPECT_EQ(info.kinds.at(number_of(mixed, "gaussian")).items, 20000U);
  EXPECT_EQ(info.surfels, 22500U);
  EXPECT_EQ(info.harmonics_degree, 1);
  EXPECT_EQ(info.color_bits, 8);
  ASSERT_EQ(mixed->volumes().size(), 1U);
  EXPECT_EQ(mixed->volumes()[0].size, glm::u32vec3(40, 20, 10));
  EXPECT_LE(info.bounds.min.z, -0.5);
  EXPECT_GE(info.bounds.max.z, 9);
  EXPECT_GE(info.bounds.max.x, 39);
}

TEST_F(MixedBuildTest, TheOrderOfTheInputsDoesNotMatter) {
  ASSERT_TRUE(build({splats_, grid_, scan_}, folder_ / "a.surf"));
  ASSERT_TRUE(build({scan_, splats_, grid_}, folder_ / "b.surf"));
  EXPECT_EQ(testing::file_content(folder_ / "a.surf"), testing::file_content(folder_ / "b.surf"));
}

TEST_F(MixedBuildTest, AScanWithoutColoursStaysWithoutThem) {
  const fs::path plain = testing::write(folder_ / "plain.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n3 1 0\n4 1 0\n");
  const ModelPointer mixed = build({plain, splats_}, folder_ / "plain.surf");
  ASSERT_TRUE(mixed);
  EXPECT_EQ(mixed->info().color_bits, 0);
  for (size_t i = 0; i < mixed->blocks().size(); ++i) {
    if (mixed->blocks()[i].kind != number_of(mixed, "surfel")) continue;
    EXPECT_TRUE(mixed->decode(i));
  }
}

}  // namespace
}  // namespace surfcast::builder
