#include "builder/volume_builds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "volume/read_brick.h"

namespace surfcast::builder {
namespace {

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

/// Calls `use` with the place in the level and the value of every sample of a brick.
template <typename Use>
void for_each(const volume::Brick& brick, const Use& use) {
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

}  // namespace

Grid noise_grid(const glm::u32vec3& size) {
  std::mt19937 random(1);
  return make_grid(size, [&](uint32_t i, uint32_t, uint32_t) { return i + random() % 4096; });
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

fs::path write_grid(const fs::path& path, const Grid& grid, bool big) {
  const std::string endian = big ? "endian: big\n" : "endian: little\n";
  return write_text(path, nrrd_header(grid, endian + "encoding: raw\n") + bytes_of(grid, big));
}

Result<BuildReport> build(const fs::path& grid, const fs::path& target, const BuildOptions& options) {
  return build_model(std::array{grid}, target, options, [](const BuildStep&) {});
}

model::ModelFile build_and_open(const model::TestFolder& folder, const Grid& grid, bool big) {
  const Result<BuildReport> report = build(write_grid(folder / "grid.nrrd", grid, big), folder / "grid.surf");
  EXPECT_TRUE(report) << report.error().message;
  return std::move(*model::ModelFile::open(folder / "grid.surf"));
}

std::string fault_of(const fs::path& grid, const fs::path& target, const BuildOptions& options) {
  const Result<BuildReport> report = build(grid, target, options);
  EXPECT_FALSE(fs::exists(target) && !report);
  return report ? std::string() : report.error().message;
}

LevelSamples::LevelSamples(const model::ModelFile& model, uint32_t level)
    : size_(volume::level_size(model.volumes()[0].size, level)),
      values_(size_t{size_.x} * size_.y * size_.z, std::numeric_limits<double>::quiet_NaN()) {
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (model.brick(block).level != level) continue;
    bricks_.push_back(*volume::read_brick(model, block));
    keep(bricks_.back());
  }
}

size_t LevelSamples::index_of(const glm::i64vec3& at) const {
  return static_cast<size_t>((at.z * size_.y + at.y) * size_.x + at.x);
}

double LevelSamples::largest_difference(const std::vector<double>& level) const {
  double largest = 0;
  for (const volume::Brick& brick : bricks_) {
    for_each(brick, [&](const glm::i64vec3& at, double value) {
      const glm::i64vec3 inside = glm::clamp(at, glm::i64vec3(0), glm::i64vec3(size_) - int64_t{1});
      largest = std::max(largest, std::abs(value - level[index_of(inside)]));
    });
  }
  return largest;
}

void LevelSamples::keep(const volume::Brick& brick) {
  const glm::i64vec3 first(brick.header.brick * 32U);
  const glm::i64vec3 end = first + glm::i64vec3(brick.header.count);
  for_each(brick, [&](const glm::i64vec3& at, double value) {
    if (glm::all(glm::greaterThanEqual(at, first)) && glm::all(glm::lessThan(at, end))) values_[index_of(at)] = value;
  });
}

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

}  // namespace surfcast::builder
