// Previews of volumes: models of every few samples.

#include <gtest/gtest.h>

#include "builder/volume_builds.h"

namespace surfcast::builder {
namespace {

TEST(BuildVolumes, a_preview_has_every_few_samples_at_their_places) {
  const model::TestFolder folder;
  const auto value = [](uint32_t i, uint32_t j, uint32_t k) { return i + 100 * j + 10'000 * k; };
  Grid grid = make_grid({31, 20, 3}, value);
  grid.type = "int32";
  grid.lines = "spacings: 1 2 4\n";
  BuildOptions options;
  options.sample = 50;  // every fourth: 8 x 5 x 1; of every third there were 77
  const Result<BuildReport> report = build(write_grid(folder / "grid.nrrd", grid), folder / "grid.surf", options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->samples, 40U);
  EXPECT_EQ(report->points_in_scans, 31U * 20 * 3);
  const model::ModelFile model = std::move(*model::ModelFile::open(folder / "grid.surf"));
  const model::Volume& volume = model.volumes()[0];
  EXPECT_EQ(volume.size, glm::u32vec3(8, 5, 1));
  EXPECT_EQ(volume.index_to_world[0], glm::dvec3(4, 0, 0));
  EXPECT_EQ(volume.index_to_world[1], glm::dvec3(0, 8, 0));
  EXPECT_EQ(volume.index_to_world[3], glm::dvec3(0));
  EXPECT_EQ(volume.low, 0);
  EXPECT_EQ(volume.high, 28 + 100 * 16);
  const LevelSamples level(model, 0);
  ASSERT_EQ(level.values().size(), 40U);
  EXPECT_EQ(level.values()[0], 0);
  EXPECT_EQ(level.values()[5], 20);
  EXPECT_EQ(level.values()[39], 28 + 100 * 16);
}

TEST(BuildVolumes, a_preview_of_a_small_grid_is_the_grid) {
  const model::TestFolder folder;
  const fs::path grid = write_grid(folder / "grid.nrrd", noise_grid({9, 5, 7}));
  BuildOptions options;
  options.sample = 9 * 5 * 7;
  ASSERT_TRUE(build(grid, folder / "sample.surf", options));
  ASSERT_TRUE(build(grid, folder / "all.surf"));
  EXPECT_EQ(model::read_bytes(folder / "sample.surf"), model::read_bytes(folder / "all.surf"));
}

}  // namespace
}  // namespace surfcast::builder
