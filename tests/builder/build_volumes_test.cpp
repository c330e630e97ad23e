// Inputs of volumes: those that are refused, and those that are completed.

#include <algorithm>
#include <array>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/volume_builds.h"
#include "support/packing.h"
#include "volume/read_brick.h"

namespace surfcast::builder {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(BuildVolumes, samples_that_are_not_finite_become_the_lowest_and_are_counted) {
  const model::TestFolder folder;
  Grid grid = make_grid({40, 4, 4}, [](uint32_t i, uint32_t, uint32_t) { return double(i) - 5; });
  grid.type = "float";
  grid.samples[7] = std::numeric_limits<double>::quiet_NaN();
  grid.samples[8] = std::numeric_limits<double>::infinity();
  const Result<BuildReport> report = build(write_grid(folder / "grid.nrrd", grid), folder / "grid.surf");
  ASSERT_TRUE(report);
  EXPECT_THAT(report->scan.notes,
              ::testing::ElementsAre("grid: 2 samples are not finite and count as the lowest value"));
  const LevelSamples level(*model::ModelFile::open(folder / "grid.surf"), 0);
  EXPECT_EQ(level.values()[7], -5);
  EXPECT_EQ(level.values()[8], -5);
  std::ranges::fill(grid.samples, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(fault_of(write_grid(folder / "none.nrrd", grid), folder / "none.surf"),
              HasSubstr("none.nrrd: no sample of the grid is finite"));
}

TEST(BuildVolumes, values_beyond_single_precision_are_refused) {
  const model::TestFolder folder;
  Grid grid = make_grid({4, 4, 4}, [](uint32_t i, uint32_t, uint32_t) { return i * 1e39; });
  grid.type = "double";
  EXPECT_THAT(fault_of(write_grid(folder / "far.nrrd", grid), folder / "far.surf"), HasSubstr("beyond 3.4e38"));
}

TEST(BuildVolumes, truncated_files_leave_no_model) {
  const model::TestFolder folder;
  const Grid grid = noise_grid({64, 64, 40});
  const std::string bytes = bytes_of(grid, false);
  const std::string raw = nrrd_header(grid, "endian: little\nencoding: raw\n") + bytes;
  EXPECT_THAT(fault_of(write_text(folder / "raw.nrrd", raw.substr(0, raw.size() - 1)), folder / "raw.surf"),
              HasSubstr("raw.nrrd: truncated"));
  const std::string packed = nrrd_header(grid, "endian: little\nencoding: gzip\n") + testing::gzip(bytes);
  EXPECT_EQ(fault_of(write_text(folder / "whole.nrrd", packed), folder / "whole.surf"), "");
  for (const double share : {0.5, 0.99, 0.9999}) {
    const auto length = static_cast<size_t>(share * static_cast<double>(packed.size()));
    const std::string fault = fault_of(write_text(folder / "cut.nrrd", packed.substr(0, length)), folder / "cut.surf");
    EXPECT_THAT(fault, HasSubstr("cut.nrrd: "));
    EXPECT_THAT(fault, Not(HasSubstr("\n")));
  }
}

TEST(BuildVolumes, sizes_beyond_the_file_are_refused_before_memory_is_taken) {
  const model::TestFolder folder;
  Grid grid;
  grid.samples = {1, 2, 3};
  for (const uint32_t side : {100U, 100000U, UINT32_MAX}) {
    grid.size = glm::u32vec3(side);
    const std::string fault = fault_of(write_grid(folder / "big.nrrd", grid), folder / "big.surf");
    EXPECT_THAT(fault, HasSubstr("big.nrrd: "));
    EXPECT_THAT(fault, Not(HasSubstr("\n")));
  }
}

TEST(BuildVolumes, a_memory_budget_that_is_too_small_is_refused_in_one_line) {
  const model::TestFolder folder;
  const fs::path grid = write_grid(folder / "grid.nrrd", noise_grid({600, 600, 40}));
  BuildOptions options;
  options.memory = uint64_t{64} << 20;
  const std::string fault = fault_of(grid, folder / "grid.surf", options);
  EXPECT_THAT(fault, HasSubstr("grid.surf: a memory budget of 64M is too small for these grids: it takes at least "));
  options.memory = uint64_t{200} << 20;
  EXPECT_EQ(fault_of(grid, folder / "grid.surf", options), "");
}

TEST(BuildVolumes, tensors_are_glyphs_not_volumes) {
  const model::TestFolder folder;
  const fs::path tensors =
      write_text(folder / "dti.nrrd",
                 "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 6 2 2 2\nkinds: 3D-symmetric-matrix space space space\n"
                 "encoding: raw\n\n" +
                     std::string(48, 'a'));
  EXPECT_THAT(fault_of(tensors, folder / "dti.surf"),
              HasSubstr("dti.nrrd: 8 of 8 glyphs cannot be drawn: 8 without positive eigenvalues"));
}

TEST(BuildVolumes, a_damaged_grid_beside_a_scan_is_found_before_the_scan_is_read) {
  const model::TestFolder folder;
  const fs::path grid = write_text(folder / "grid.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\n\n");
  const fs::path scan = write_text(folder / "scan.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  std::vector<std::string> stages;
  const Result<BuildReport> report = build_model(std::array{scan, grid}, folder / "both.surf", {},
                                                 [&](const BuildStep& step) { stages.emplace_back(step.stage); });
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("grid.nrrd"));
  EXPECT_TRUE(stages.empty());
  EXPECT_FALSE(fs::exists(folder / "both.surf"));
}

TEST(BuildVolumes, several_grids_are_volumes_of_one_model) {
  const model::TestFolder folder;
  const std::array grids{write_grid(folder / "a.nrrd", noise_grid({40, 4, 4})),
                         write_grid(folder / "b.nrrd", noise_grid({5, 6, 70}))};
  ASSERT_TRUE(build_model(grids, folder / "both.surf", {}, [](const BuildStep&) {}));
  const Result<model::ModelFile> model = model::ModelFile::open(folder / "both.surf");
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->volumes().size(), 2U);
  EXPECT_EQ(model->volumes()[1].name, "b");
  EXPECT_EQ(model->info().source_names, (std::vector<std::string>{"a.nrrd", "b.nrrd"}));
  for (uint32_t block = 0; block < model->blocks().size(); ++block) EXPECT_TRUE(volume::read_brick(*model, block));
}

TEST(BuildVolumes, progress_reaches_the_end_of_both_stages) {
  const model::TestFolder folder;
  const fs::path grid = write_grid(folder / "grid.nrrd", noise_grid({10, 10, 50}));
  std::vector<std::pair<std::string, double>> last;
  const auto note = [&](const BuildStep& step) {
    if (last.empty() || last.back().first != step.stage) last.emplace_back(step.stage, 0);
    EXPECT_GE(step.done, last.back().second);
    last.back().second = step.done;
  };
  ASSERT_TRUE(build_model(std::array{grid}, folder / "grid.surf", {}, note));
  EXPECT_EQ(last, (std::vector<std::pair<std::string, double>>{{"measuring samples", 1}, {"writing bricks", 1}}));
}

TEST(BuildVolumes, damaged_bricks_with_right_checksums_are_refused) {
  const model::TestFolder folder;
  const model::ModelFile model = build_and_open(folder, noise_grid({20, 20, 20}));
  const Result<model::StoredBlock> stored = model.stored(0);
  ASSERT_TRUE(stored);
  EXPECT_TRUE(volume::read_brick(model, 0));
  std::vector<char> bytes = model::read_bytes(folder / "grid.surf");
  bytes[64 + 20] ^= 1;
  write_text(folder / "damaged.surf", std::string(bytes.begin(), bytes.end()));
  const Result<model::ModelFile> damaged = model::ModelFile::open(folder / "damaged.surf");
  ASSERT_TRUE(damaged);
  const Result<volume::Brick> brick = volume::read_brick(*damaged, 0);
  ASSERT_FALSE(brick);
  EXPECT_THAT(brick.error().message, HasSubstr("damaged.surf: block 0: damaged"));
}

}  // namespace
}  // namespace surfcast::builder
