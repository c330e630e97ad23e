#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/common.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "builder/build_model.h"
#include "model/test_folder.h"
#include "support/digest_table.h"
#include "support/packing.h"
#include "support/sha256.h"
#include "volume/read_brick.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// A grid of numbers and how it is written.
struct Grid {
  glm::u32vec3 size{1};
  std::string type = "uint16";
  std::string lines = "spacings: 1 1 1\n";  ///< more of the header
  std::vector<double> samples;

  [[nodiscard]] double at(uint32_t i, uint32_t j, uint32_t k) const {
    return samples[(size_t{k} * size.y + j) * size.x + i];
  }
};

template <typename Sample>
Grid make_grid(const glm::u32vec3& size, const Sample& sample) {
  Grid grid;
  grid.size = size;
  for (uint32_t k = 0; k < size.z; ++k) {
    for (uint32_t j = 0; j < size.y; ++j) {
      for (uint32_t i = 0; i < size.x; ++i) grid.samples.push_back(static_cast<double>(sample(i, j, k)));
    }
  }
  return grid;
}

Grid noise_grid(const glm::u32vec3& size) {
  std::mt19937 random(1);
  return make_grid(size, [&](uint32_t i, uint32_t, uint32_t) { return i + random() % 4096; });
}

template <typename T>
std::string bytes_of(const std::vector<double>& samples, bool big) {
  std::string bytes;
  for (const double sample : samples) {
    const auto value = static_cast<T>(sample);
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big) std::ranges::reverse(raw);
    bytes.append(raw.begin(), raw.end());
  }
  return bytes;
}

std::string bytes_of(const Grid& grid, bool big) {
  if (grid.type == "uint8") return bytes_of<uint8_t>(grid.samples, big);
  if (grid.type == "int16") return bytes_of<int16_t>(grid.samples, big);
  if (grid.type == "int32") return bytes_of<int32_t>(grid.samples, big);
  if (grid.type == "float") return bytes_of<float>(grid.samples, big);
  if (grid.type == "double") return bytes_of<double>(grid.samples, big);
  return bytes_of<uint16_t>(grid.samples, big);
}

std::string nrrd_header(const Grid& grid, const std::string& more) {
  return "NRRD0004\ntype: " + grid.type + "\ndimension: 3\nsizes: " + std::to_string(grid.size.x) + " " +
         std::to_string(grid.size.y) + " " + std::to_string(grid.size.z) + "\n" + grid.lines + more + "\n";
}

fs::path write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

fs::path write_grid(const fs::path& path, const Grid& grid, bool big = false) {
  const std::string endian = big ? "endian: big\n" : "endian: little\n";
  return write_text(path, nrrd_header(grid, endian + "encoding: raw\n") + bytes_of(grid, big));
}

Result<BuildReport> build(const fs::path& grid, const fs::path& target, const BuildOptions& options = {}) {
  return build_model(std::array{grid}, target, options, [](const BuildStep&) {});
}

/// Builds a grid and opens the model.
model::ModelFile build_and_open(const model::TestFolder& folder, const Grid& grid, bool big = false) {
  const Result<BuildReport> report = build(write_grid(folder / "grid.nrrd", grid, big), folder / "grid.surf");
  EXPECT_TRUE(report) << report.error().message;
  return std::move(*model::ModelFile::open(folder / "grid.surf"));
}

std::string fault_of(const fs::path& grid, const fs::path& target, const BuildOptions& options = {}) {
  const Result<BuildReport> report = build(grid, target, options);
  EXPECT_FALSE(fs::exists(target) && !report);
  return report ? std::string() : report.error().message;
}

/// A level as the bricks of a model give it. Samples in halos are compared with it.
class LevelSamples {
 public:
  LevelSamples(const model::ModelFile& model, uint32_t level)
      : size_(volume::level_size(model.volumes()[0].size, level)),
        values_(size_t{size_.x} * size_.y * size_.z, std::numeric_limits<double>::quiet_NaN()) {
    for (uint32_t block = 0; block < model.blocks().size(); ++block) {
      if (model.brick(block).level != level) continue;
      bricks_.push_back(*volume::read_brick(model, block));
      keep(bricks_.back());
    }
  }

  [[nodiscard]] const std::vector<double>& values() const { return values_; }

  /// The largest difference of a sample of any brick, halos included, to the same sample of `level`.
  [[nodiscard]] double largest_difference(const std::vector<double>& level) const {
    double largest = 0;
    for (const volume::Brick& brick : bricks_) {
      for_each(brick, [&](const glm::i64vec3& at, double value) {
        const glm::i64vec3 inside = glm::clamp(at, glm::i64vec3(0), glm::i64vec3(size_) - int64_t{1});
        largest = std::max(largest, std::abs(value - level[index_of(inside)]));
      });
    }
    return largest;
  }

 private:
  [[nodiscard]] size_t index_of(const glm::i64vec3& at) const {
    return static_cast<size_t>((at.z * size_.y + at.y) * size_.x + at.x);
  }

  template <typename Use>
  static void for_each(const volume::Brick& brick, const Use& use) {
    const glm::u32vec3 stored = volume::stored_size(brick.header.count);
    const glm::i64vec3 first = glm::i64vec3(brick.header.brick * 32U) - int64_t{2};
    size_t at = 0;
    for (uint32_t k = 0; k < stored.z; ++k) {
      for (uint32_t j = 0; j < stored.y; ++j) {
        for (uint32_t i = 0; i < stored.x; ++i) {
          use(first + glm::i64vec3(i, j, k), brick.header.value(brick.codes[at++]));
        }
      }
    }
  }

  void keep(const volume::Brick& brick) {
    const glm::i64vec3 first(brick.header.brick * 32U);
    const glm::i64vec3 end = first + glm::i64vec3(brick.header.count);
    for_each(brick, [&](const glm::i64vec3& at, double value) {
      if (glm::all(glm::greaterThanEqual(at, first)) && glm::all(glm::lessThan(at, end))) values_[index_of(at)] = value;
    });
  }

  glm::u32vec3 size_;
  std::vector<double> values_;
  std::vector<volume::Brick> bricks_;
};

/// The level above, by its definition and in double precision.
Grid halved(const Grid& grid) {
  return make_grid((grid.size + 1U) / 2U, [&](uint32_t i, uint32_t j, uint32_t k) {
    double sum = 0;
    for (uint32_t corner = 0; corner < 8; ++corner) {
      sum +=
          grid.at(std::min(2 * i + (corner & 1), grid.size.x - 1), std::min(2 * j + (corner >> 1 & 1), grid.size.y - 1),
                  std::min(2 * k + (corner >> 2), grid.size.z - 1));
    }
    return sum / 8;
  });
}

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

TEST(BuildVolumes, tensors_are_refused_by_name) {
  const model::TestFolder folder;
  const fs::path tensors =
      write_text(folder / "dti.nrrd",
                 "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 6 2 2 2\nkinds: 3D-symmetric-matrix space space space\n"
                 "encoding: raw\n\n" +
                     std::string(48, 'a'));
  EXPECT_THAT(fault_of(tensors, folder / "dti.surf"),
              HasSubstr("dti.nrrd: holds tensors of 6 components; volumes are made of grids with one number a sample"));
}

TEST(BuildVolumes, scans_and_grids_together_are_refused_by_name) {
  const model::TestFolder folder;
  const fs::path grid = write_grid(folder / "grid.nrrd", noise_grid({4, 4, 4}));
  const fs::path scan = write_text(folder / "scan.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  const Result<BuildReport> report =
      build_model(std::array{scan, grid}, folder / "both.surf", {}, [](const BuildStep&) {});
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("grid.nrrd: is of another kind than " + scan.string()));
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
