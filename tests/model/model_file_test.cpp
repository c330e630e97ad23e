#include "model/model_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <oneapi/tbb/global_control.h>

#include "model/round_trip.h"
#include "model/scalar_bits.h"

namespace surfcast::model {
namespace {

constexpr double kNormalError = 0.1 * std::numbers::pi / 180;
const double kRadiusError = std::exp2(-11.5);

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

TEST(ModelFile, GivesEverySurfelOfASphereBack) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(50000);
  for (size_t i = 0; i < cloud.size(); ++i) cloud.weights[i] = 1 / (1 + static_cast<float>(i));
  const DecodedModel model = round_trip(cloud, folder / "model.surf");
  EXPECT_GT(model.blocks.size(), 1u);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto [block, at] = model.surfels[i];
    ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), cloud.radii[i] / 256);
    ASSERT_LT(angle_between(block->normals[at], cloud.normals[i]), kNormalError);
    ASSERT_NEAR(block->radii[at] / cloud.radii[i], 1, kRadiusError);
    ASSERT_NEAR(block->weights[at] / cloud.weights[i], 1, 0.011);
    ASSERT_EQ(block->colors[at], cloud.colors->values[i]);
  }
}

TEST(ModelFile, DescribesTheModelInItsHeader) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(1000);
  cloud.z_up = false;
  cloud.scalars.push_back({"intensity", std::vector<uint16_t>(1000, 7)});
  cloud.sources = {{"a.ply", 0, 400, std::nullopt}, {"b.ply", 400, 600, std::nullopt}};
  const ModelFile model = write_and_open(cloud, folder / "model.surf");
  const ModelInfo& info = model.info();
  EXPECT_EQ(info.surfels, 1000u);
  EXPECT_TRUE(info.oriented);
  EXPECT_FALSE(info.z_up);
  EXPECT_EQ(info.color_bits, 8);
  EXPECT_EQ(info.scalar_names, (std::vector<std::string>{"intensity"}));
  EXPECT_EQ(info.source_names, (std::vector<std::string>{"a.ply", "b.ply"}));
  const geometry::Box bounds = cloud.bounds();
  EXPECT_LT(glm::length(info.bounds.min - bounds.min), cloud.radii[0] / 128);
  EXPECT_LT(glm::length(info.bounds.max - bounds.max), cloud.radii[0] / 128);
}

TEST(ModelFile, HasItsElevationsAlongTheVerticalAxis) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(1000);
  for (glm::dvec3& position : cloud.positions) position.y = 3 + 0.25 * position.y;
  for (const bool z_up : {false, true}) {
    cloud.z_up = z_up;
    const ModelFile model = write_and_open(cloud, folder / (z_up ? "z.surf" : "y.surf"));
    const int axis = z_up ? 2 : 1;
    EXPECT_EQ(model.info().elevation.low, model.info().bounds.min[axis]);
    EXPECT_EQ(model.info().elevation.high, model.info().bounds.max[axis]);
  }
}

TEST(ModelFile, StoresNeitherColorNorAttributesThatAScanDoesNotHave) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(100);
  cloud.colors.reset();
  const ModelFile model = write_and_open(cloud, folder / "model.surf");
  EXPECT_EQ(model.info().color_bits, 0);
  const Result<DecodedBlock> block = model.decode(0);
  ASSERT_TRUE(block);
  EXPECT_TRUE(block->colors.empty());
  EXPECT_TRUE(block->scalars.empty());
}

template <typename T>
std::vector<T> awkward_values(size_t count) {
  using Limits = std::numeric_limits<T>;
  std::vector<T> values{Limits::min(), Limits::lowest(), Limits::max(), T(0), T(1)};
  if constexpr (std::is_signed_v<T>) values.push_back(T(-1));
  if constexpr (std::is_floating_point_v<T>) {
    values.insert(values.end(), {T(-0.0), Limits::denorm_min(), Limits::infinity(), -Limits::infinity(),
                                 Limits::quiet_NaN(), -Limits::quiet_NaN()});
  }
  std::mt19937_64 random(11);
  while (values.size() < count) values.push_back(from_ordered_bits<T>(static_cast<BitsOf<T>>(random())));
  return values;
}

/// Compares bit patterns, so NaNs compare as well.
template <typename T>
bool same_bits(T a, T b) {
  return to_ordered_bits(a) == to_ordered_bits(b);
}

template <typename T>
void expect_exact(const DecodedModel& model, const std::vector<T>& values, size_t attribute) {
  for (size_t i = 0; i < values.size(); ++i) {
    const auto [block, at] = model.surfels[i];
    ASSERT_TRUE(same_bits(std::get<std::vector<T>>(block->scalars[attribute].values)[at], values[i])) << i;
  }
}

TEST(ModelFile, GivesScalarAttributesOfEveryTypeBackExactly) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(3000);
  const auto add = [&](const char* name, auto example) {
    cloud.scalars.push_back({name, awkward_values<decltype(example)>(cloud.size())});
  };
  add("u8", uint8_t{});
  add("i8", int8_t{});
  add("u16", uint16_t{});
  add("i16", int16_t{});
  add("u32", uint32_t{});
  add("i32", int32_t{});
  add("u64", uint64_t{});
  add("i64", int64_t{});
  add("f32", float{});
  add("f64", double{});
  const DecodedModel model = round_trip(cloud, folder / "model.surf");
  for (size_t attribute = 0; attribute < cloud.scalars.size(); ++attribute) {
    EXPECT_EQ(model.blocks[0].scalars[attribute].name, cloud.scalars[attribute].name);
    std::visit([&](const auto& values) { expect_exact(model, values, attribute); }, cloud.scalars[attribute].values);
  }
}

TEST(ModelFile, GivesSixteenBitColorsBackExactly) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(2000);
  cloud.colors->bits = 16;
  std::mt19937 random(3);
  for (glm::u16vec3& color : cloud.colors->values) color = glm::u16vec3(random(), random(), random());
  cloud.colors->values[0] = {0, 65535, 0};
  cloud.colors->values[1] = {65535, 0, 65535};
  const DecodedModel model = round_trip(cloud, folder / "model.surf");
  for (size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(model.surfels[i].block->colors[model.surfels[i].index], cloud.colors->values[i]);
  }
}

TEST(ModelFile, GivesCoordinatesOnAGridBackToTheLastBit) {
  const TestFolder folder;
  // Eastings and northings of 5e6 m in millimetres, as LAS computes them; neither scale nor sum is a binary fraction.
  const surfel::Grid grid{{0.001, 0.001, 0.001}, {500000.123, 4999999.987, -12.5}};
  surfel::SurfelCloud cloud;
  std::mt19937 random(5);
  std::uniform_int_distribution<int64_t> wide(-2000000000, 2000000000);
  for (int i = 0; i < 20000; ++i) {
    cloud.positions.push_back(grid.position({wide(random), wide(random), wide(random) / 1000}));
  }
  cloud.sources.push_back({"scan.las", 0, cloud.size(), grid});
  const DecodedModel model = round_trip(finish_cloud(cloud), folder / "model.surf");
  for (size_t i = 0; i < cloud.size(); ++i) ASSERT_EQ(model.position(i), cloud.positions[i]) << i;
}

TEST(ModelFile, KeepsSourcesOfDifferentGridsExactSideBySide) {
  const TestFolder folder;
  const surfel::Grid millimetres{{0.001, 0.001, 0.001}, {0.3, 0.7, 0.1}};
  const surfel::Grid degrees{{1e-7, 1e-7, 0.01}, {0, 0, 100.05}};
  surfel::SurfelCloud cloud;
  for (int i = 0; i < 500; ++i) cloud.positions.push_back(millimetres.position({i * 7, i * 3, i}));
  for (int i = 0; i < 500; ++i) cloud.positions.push_back(degrees.position({i * 70000, i * 30000, -9000 - i}));
  for (int i = 0; i < 500; ++i) cloud.positions.emplace_back(i * 0.37, i * 0.11, 0);
  cloud.sources = {{"a.las", 0, 500, millimetres}, {"b.las", 500, 500, degrees}, {"c.ply", 1000, 500, std::nullopt}};
  const DecodedModel model = round_trip(finish_cloud(cloud), folder / "model.surf");
  for (size_t i = 0; i < 1000; ++i) ASSERT_EQ(model.position(i), cloud.positions[i]) << i;
  for (size_t i = 1000; i < 1500; ++i) {
    ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), 1.0 / 256);
  }
}

TEST(ModelFile, TreatsAGridThatDoesNotHoldItsPointsAsNone) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(1000);
  for (const double scale : {0.25, 1e-300}) {
    cloud.sources[0].grid = surfel::Grid{glm::dvec3(scale), glm::dvec3(0)};
    const DecodedModel model = round_trip(cloud, folder / "model.surf");
    for (size_t i = 0; i < cloud.size(); ++i) {
      ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), cloud.radii[i] / 256);
    }
  }
}

TEST(ModelFile, BoundsEachPositionErrorByItsOwnRadiusOverSpacingsOfOneToAMillion) {
  const TestFolder folder;
  surfel::SurfelCloud cloud;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10, 3 + 3 * uniform(random));  // 1 to 1e6
    cloud.positions.emplace_back(glm::dvec3(uniform(random), uniform(random), uniform(random)) * size * 10.0);
    cloud.radii.push_back(static_cast<float>(size * 1e-3));
  }
  const DecodedModel model = round_trip(finish_cloud(cloud), folder / "model.surf");
  for (size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), cloud.radii[i] / 256);
  }
}

TEST(ModelFile, KeepsItsPrecisionFarFromTheOriginAndAtAnyScale) {
  const TestFolder folder;
  for (const double scale : {1e-30, 1e-4, 1.0, 1e5, 1e30}) {
    const glm::dvec3 offset = glm::dvec3(5e6, -3e6, 100) * scale;
    surfel::SurfelCloud cloud = sphere_cloud(5000, 10 * scale);
    for (glm::dvec3& p : cloud.positions) p += offset;
    const DecodedModel model = round_trip(cloud, folder / "model.surf");
    for (size_t i = 0; i < cloud.size(); ++i) {
      ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), cloud.radii[i] / 256);
      ASSERT_NEAR(model.surfels[i].block->radii[model.surfels[i].index] / cloud.radii[i], 1, kRadiusError);
    }
  }
}

TEST(ModelFile, KeepsAWantedPrecision) {
  const TestFolder folder;
  const surfel::SurfelCloud cloud = sphere_cloud(5000);
  const DecodedModel model = round_trip(cloud, folder / "model.surf", {.precision = 1e-9});
  for (size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), 1e-9);
  }
}

TEST(ModelFile, HoldsASingleSurfel) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(1);
  cloud.positions[0] = {5e6, 1e-3, -7};
  const ModelFile model = write_and_open(cloud, folder / "model.surf");
  ASSERT_EQ(model.blocks().size(), 1u);
  const Result<DecodedBlock> block = model.decode(0);
  ASSERT_TRUE(block) << block.error().message;
  EXPECT_LE(glm::length(block->position(0) - cloud.positions[0]), cloud.radii[0] / 256);
  EXPECT_EQ(block->colors[0], cloud.colors->values[0]);
}

TEST(ModelFile, HoldsManyCoincidentSurfels) {
  const TestFolder folder;
  surfel::SurfelCloud cloud;
  cloud.positions.assign(50000, {0.1, 0.2, 0.3});
  const DecodedModel model = round_trip(finish_cloud(cloud), folder / "model.surf");
  for (size_t i = 0; i < cloud.size(); ++i) ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), 1.0 / 256);
}

TEST(ModelFile, StatesBoundsRadiiSpacingAndNormalsOfEachBlock) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(60000);
  for (size_t i = 0; i < cloud.size(); i += 7) cloud.radii[i] *= 1.5f;
  const ModelFile model = write_and_open(cloud, folder / "model.surf");
  for (size_t b = 0; b < model.blocks().size(); ++b) {
    const ldc::BlockEntry& entry = model.blocks()[b];
    const Result<DecodedBlock> block = model.decode(b);
    ASSERT_TRUE(block);
    ASSERT_EQ(block->size(), entry.items);
    geometry::Box box;
    for (size_t i = 0; i < block->size(); ++i) box.include(block->position(i));
    EXPECT_EQ(box.min, entry.bounds.min);
    EXPECT_EQ(box.max, entry.bounds.max);
    std::vector<float> radii = block->radii;
    std::sort(radii.begin(), radii.end());
    EXPECT_EQ(entry.max_radius, double{radii.back()});
    if (entry.level == 0) {
      EXPECT_EQ(entry.spacing, double{radii[radii.size() / 2]});
    } else {
      EXPECT_GE(entry.spacing, double{radii[radii.size() / 2]});
    }
    ASSERT_TRUE(entry.normals);
    for (const glm::vec3& n : block->normals) {
      ASSERT_LE(angle_between(n, entry.normals->axis), double{entry.normals->half_angle} + 1e-6);
    }
    if (entry.level == 0) {
      EXPECT_LT(entry.normals->half_angle, 2) << "a leaf holds a part of the sphere only";
    }
  }
}

TEST(ModelFile, StatesNoConeWithoutOrientation) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(1000);
  cloud.oriented = false;
  EXPECT_FALSE(write_and_open(cloud, folder / "model.surf").blocks()[0].normals);
}

TEST(ModelFile, CoarseBlocksOfAWallThatFacesAwayKeepItsCone) {
  const TestFolder folder;
  surfel::SurfelCloud cloud;
  cloud.oriented = true;
  for (int i = 0; i < 90000; ++i) cloud.positions.emplace_back(i % 300, i / 300, 0);
  cloud.normals.assign(cloud.size(), glm::vec3(0, 0, -1));
  const ModelFile model = write_and_open(finish_cloud(std::move(cloud)), folder / "model.surf");
  EXPECT_EQ(model.info().surfels, 90000u);
  EXPECT_EQ(model.info().levels, 3);
  for (const ldc::BlockEntry& block : model.blocks()) {
    ASSERT_TRUE(block.normals);
    EXPECT_LT(block.normals->axis.z, -0.9999f);
    EXPECT_LT(block.normals->half_angle, 0.01f);
  }
}

TEST(ModelFile, ABlockSaysHowFineItsValuesAre) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(40000);
  cloud.estimated_normals = true;
  cloud.estimated_radii = true;
  const DecodedModel model = round_trip(cloud, folder / "model.surf");
  double widest = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto [block, at] = model.surfels[i];
    widest = std::max(widest, angle_between(block->normals[at], cloud.normals[i]));
    ASSERT_NEAR(block->radii[at] / cloud.radii[i], 1, 0.022);
    ASSERT_LE(glm::length(model.position(i) - cloud.positions[i]), cloud.radii[i] / 256);
  }
  EXPECT_LT(widest, 10 * kNormalError);
  EXPECT_GT(widest, kNormalError) << "estimates take fewer bits";
}

TEST(ModelFile, HasTheSameBytesFromRunToRunAndForAnyNumberOfThreads) {
  const TestFolder folder;
  const surfel::SurfelCloud cloud = sphere_cloud(60000);
  write_and_open(cloud, folder / "default.surf");
  const std::vector<char> expected = read_bytes(folder / "default.surf");
  for (const size_t threads : {1u, 2u, 3u}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    write_and_open(cloud, folder / "limited.surf");
    EXPECT_EQ(read_bytes(folder / "limited.surf"), expected) << threads;
  }
}

/// With a mapped file both would end the process by SIGBUS, or hand other bytes to the decoder than were checked.
TEST(ModelFile, AFileThatIsOverwrittenOrCutOffWhileItIsOpenGivesErrors) {
  const TestFolder folder;
  const ModelFile model = write_and_open(sphere_cloud(50000), folder / "model.surf");
  const std::vector<char> whole = read_bytes(folder / "model.surf");
  ASSERT_TRUE(model.decode(0));
  std::ofstream(folder / "model.surf", std::ios::binary) << std::string(whole.size(), 'x');
  ASSERT_FALSE(model.decode(0));
  EXPECT_NE(model.decode(0).error().message.find("damaged"), std::string::npos);
  std::filesystem::resize_file(folder / "model.surf", 64);
  ASSERT_FALSE(model.decode(0));
  EXPECT_NE(model.decode(0).error().message.find("cut off"), std::string::npos);
  std::ofstream(folder / "model.surf", std::ios::binary)
      .write(whole.data(), static_cast<std::streamsize>(whole.size()));
  EXPECT_TRUE(model.decode(0));
}

}  // namespace
}  // namespace surfcast::model
