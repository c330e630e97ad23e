// The samples, levels and places of volumes that were built.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "builder/volume_builds.h"
#include "support/digest_table.h"
#include "support/sha256.h"

namespace surfcast::builder {
namespace {

TEST(BuildVolumes, every_sample_comes_back_and_halos_repeat_the_neighbours) {
  for (const char* type : {"uint8", "uint16", "int16", "int32"}) {
    const model::TestFolder folder;
    Grid grid =
        make_grid({70, 33, 64}, [](uint32_t i, uint32_t j, uint32_t k) { return (i * 7 + j * 31 + k * 3) % 251; });
    grid.type = type;
    if (grid.type == "int16") {
      for (double& sample : grid.samples) sample = sample * 250 - 31000;
    }
    const model::ModelFile model = build_and_open(folder, grid);
    EXPECT_EQ(model.volumes()[0].size, grid.size);
    EXPECT_EQ(LevelSamples(model, 0).values(), grid.samples) << type;
    EXPECT_EQ(LevelSamples(model, 0).largest_difference(grid.samples), 0);
  }
}

TEST(BuildVolumes, levels_are_means_of_the_source) {
  const model::TestFolder folder;
  const Grid grid = noise_grid({133, 66, 40});
  const model::ModelFile model = build_and_open(folder, grid);
  ASSERT_EQ(model.info().levels, 4);
  Grid level = grid;
  for (uint32_t number = 1; number < 4; ++number) {
    level = halved(level);
    const double difference = LevelSamples(model, number).largest_difference(level.samples);
    EXPECT_LE(difference, number == 1 ? 0 : 1.0 / 16) << number;
  }
}

TEST(BuildVolumes, floats_are_within_half_a_code_of_the_range_of_their_brick) {
  const model::TestFolder folder;
  Grid grid = make_grid({40, 40, 40}, [](uint32_t i, uint32_t j, uint32_t k) {
    return float(1e-4 * std::sin(0.1 * i) * std::cos(0.2 * j) + 1e-5 * k);
  });
  for (const char* type : {"float", "double"}) {
    grid.type = type;
    const model::ModelFile model = build_and_open(folder, grid);
    const auto [low, high] = std::ranges::minmax(grid.samples);
    EXPECT_EQ(model.volumes()[0].low, low);
    EXPECT_EQ(model.volumes()[0].high, high);
    EXPECT_LE(LevelSamples(model, 0).largest_difference(grid.samples), (high - low) / 131070 * 1.0001);
    EXPECT_LE(LevelSamples(model, 1).largest_difference(halved(grid).samples), (high - low) / 131070 * 1.01);
  }
}

TEST(BuildVolumes, the_model_does_not_depend_on_the_number_of_threads) {
  const model::TestFolder folder;
  const fs::path grid = write_grid(folder / "grid.nrrd", noise_grid({100, 70, 90}));
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    ASSERT_TRUE(build(grid, folder / (std::to_string(threads) + ".surf").c_str()));
  }
  EXPECT_EQ(model::read_bytes(folder / "1.surf"), model::read_bytes(folder / "2.surf"));
  EXPECT_EQ(model::read_bytes(folder / "1.surf"), model::read_bytes(folder / "7.surf"));
}

TEST(BuildVolumes, the_histogram_counts_every_sample) {
  const model::TestFolder folder;
  Grid grid = make_grid({64, 16, 1}, [](uint32_t i, uint32_t j, uint32_t) { return 64 * j + i; });
  grid.type = "int16";
  const model::ModelFile model = build_and_open(folder, grid);
  const std::vector<uint64_t>& histogram = model.volumes()[0].histogram;
  // 1024 values from 0 to 1023 in 1024 bins of 1023 / 1024.
  EXPECT_EQ(histogram, std::vector<uint64_t>(1024, 1));
}

TEST(BuildVolumes, bounds_hold_the_bricks_and_spacings_rise_with_the_level) {
  const model::TestFolder folder;
  Grid grid = noise_grid({70, 40, 35});
  grid.lines =
      "space: left-posterior-superior\nspace directions: (0,2,0.5) (-3,0,0) (0,0.25,-1.5)\n"
      "space origin: (5000000,-7,1e-4)\n";
  const model::ModelFile model = build_and_open(folder, grid);
  const model::Volume& volume = model.volumes()[0];
  EXPECT_EQ(volume.frame, model::WorldFrame::kLps);
  EXPECT_EQ(volume.index_to_world[2], glm::dvec3(0, 0.25, -1.5));
  EXPECT_EQ(volume.index_to_world[3], glm::dvec3(5e6, -7, 1e-4));
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    const ldc::BlockEntry& entry = model.blocks()[block];
    const model::BrickRecord& brick = model.brick(block);
    const volume::IndexBox box = volume::brick_box(volume.size, brick.level, brick.brick);
    for (const glm::dvec3& corner : {box.low, box.high, glm::dvec3(box.low.x, box.high.y, box.low.z)}) {
      const glm::dvec3 p = volume.index_to_world * glm::dvec4(corner, 1);
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(p, entry.bounds.min - 1e-8)));
      EXPECT_TRUE(glm::all(glm::lessThanEqual(p, entry.bounds.max + 1e-8)));
    }
    EXPECT_FLOAT_EQ(static_cast<float>(entry.spacing), static_cast<float>(1.08 * 3 * std::exp2(brick.level)));
    EXPECT_EQ(entry.level, static_cast<int>(brick.level));
  }
  EXPECT_LT(model.info().bounds.size().x, 3 * 40 + 1);
}

TEST(BuildVolumes, a_row_of_samples_is_a_volume) {
  for (const glm::u32vec3 size :
       {glm::u32vec3(1, 1, 100), glm::u32vec3(100, 1, 1), glm::u32vec3(1), glm::u32vec3(50, 1, 33)}) {
    const model::TestFolder folder;
    const Grid grid = noise_grid(size);
    const model::ModelFile model = build_and_open(folder, grid);
    EXPECT_EQ(LevelSamples(model, 0).largest_difference(grid.samples), 0);
    EXPECT_GT(std::min({model.info().bounds.size().x, model.info().bounds.size().y, model.info().bounds.size().z}),
              0.9);
  }
}

TEST(BuildVolumes, big_endian_samples_are_the_same) {
  const model::TestFolder folder;
  Grid grid = noise_grid({33, 20, 3});
  EXPECT_EQ(LevelSamples(build_and_open(folder, grid, true), 0).values(), grid.samples);
  grid.type = "float";
  EXPECT_EQ(LevelSamples(build_and_open(folder, grid, true), 0).largest_difference(grid.samples), 0)
      << "integers in floats";
}

TEST(BuildVolumes, negative_spacing_and_sheared_axes_are_kept) {
  const model::TestFolder folder;
  Grid grid = noise_grid({40, 5, 6});
  grid.lines = "space dimension: 3\nspace directions: (-0.5,0,0) (0.25,2,0) (0,0,1)\nspace origin: (10,20,30)\n";
  const model::ModelFile model = build_and_open(folder, grid);
  EXPECT_EQ(model.volumes()[0].index_to_world[0], glm::dvec3(-0.5, 0, 0));
  EXPECT_NEAR(model.info().bounds.min.x, 10 - 0.5 * 39, 1e-6);
  EXPECT_NEAR(model.info().bounds.max.x, 10 + 0.25 * 4, 1e-6);
  EXPECT_EQ(LevelSamples(model, 0).values(), grid.samples);
}

TEST(BuildVolumes, a_constant_field_is_one_value_in_every_level) {
  for (const char* type : {"uint8", "float", "double"}) {
    const model::TestFolder folder;
    Grid grid = make_grid({70, 66, 65}, [](uint32_t, uint32_t, uint32_t) { return 0.1F; });
    if (std::string(type) == "uint8") std::ranges::fill(grid.samples, 7.0);
    grid.type = type;
    const model::ModelFile model = build_and_open(folder, grid);
    EXPECT_EQ(model.volumes()[0].low, model.volumes()[0].high);
    for (uint32_t level = 0; level < 3; ++level) {
      const LevelSamples samples(model, level);
      for (const double value : samples.values()) ASSERT_EQ(value, grid.samples[0]);
    }
  }
}

TEST(BuildVolumes, tiny_and_huge_values_and_places_are_kept) {
  const model::TestFolder folder;
  for (const double scale : {1e-30, 1e30}) {
    Grid grid = make_grid({35, 3, 3}, [&](uint32_t i, uint32_t j, uint32_t k) { return scale * (i + j + k); });
    grid.type = "double";
    grid.lines =
        "space dimension: 3\nspace directions: (1e-4,0,0) (0,1e-4,0) (0,0,1e-4)\nspace origin: (5e6,5e6,5e6)\n";
    const model::ModelFile model = build_and_open(folder, grid);
    EXPECT_LE(LevelSamples(model, 0).largest_difference(grid.samples), 38 * scale / 131070);
    EXPECT_NEAR(model.info().bounds.size().x, 34e-4, 1e-7);
  }
}

/// Compares the samples of models with what other decoders have read. Skipped without a folder of real files.
TEST(BuildVolumes, every_real_file_has_the_samples_of_its_digest) {
  const auto data = testing::real_data();
  if (!data) GTEST_SKIP() << "SURFCAST_REAL_DATA names no folder";
  const model::TestFolder folder;
  const std::vector<testing::DigestRow> rows = testing::digest_rows(*data, "volumes");
  ASSERT_FALSE(rows.empty());
  for (const testing::DigestRow& row : rows) {
    SCOPED_TRACE(row.file);
    const Result<BuildReport> report = build(*data / row.file, folder / "model.surf");
    ASSERT_TRUE(report) << report.error().message;
    const Result<model::ModelFile> model = model::ModelFile::open(folder / "model.surf");
    ASSERT_TRUE(model);
    const model::Volume& volume = model->volumes()[0];
    EXPECT_EQ(volume.samples(), row.count);
    EXPECT_EQ(volume.low, std::stod(row.min));
    EXPECT_EQ(volume.high, std::stod(row.max));
    testing::Sha256 hash;
    hash.add_values<double>(LevelSamples(*model, 0).values());
    EXPECT_EQ(hash.finish(), row.values);
  }
}

}  // namespace
}  // namespace surfcast::builder
