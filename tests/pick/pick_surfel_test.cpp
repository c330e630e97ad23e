#include "pick/pick_surfel.h"

#include <algorithm>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>

#include <gtest/gtest.h>
#include <unistd.h>

#include "model/write_model.h"
#include "reference/resampling_filter.h"
#include "support/clouds.h"
#include "surfel/drawn_radius.h"

namespace surfcast::pick {
namespace {

const surfel::Grid kUtm{{0.01, 0.01, 0.001}, {448262, 5411932, 312}};

/// Moves the points of the cloud to a lattice in UTM coordinates, and adds classes, intensities and times.
void make_survey(surfel::SurfelCloud& cloud) {
  std::vector<uint8_t> classes;
  std::vector<uint16_t> intensities;
  std::vector<double> times;
  for (size_t i = 0; i < cloud.size(); ++i) {
    cloud.positions[i] = kUtm.position(kUtm.index(cloud.positions[i] + kUtm.offset));
    classes.push_back(static_cast<uint8_t>(i % 3 + 2));
    intensities.push_back(static_cast<uint16_t>(i));
    times.push_back(1e5 + 0.125 * static_cast<double>(i));
  }
  cloud.sources[0].grid = kUtm;
  cloud.scalars = {{"intensity", intensities}, {"classification", classes}, {"gps_time", times}};
}

surfel::SurfelCloud survey() {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(20000, 40, {0, 0, 0}, {200, 90, 20});
  testing::append(cloud, testing::square(110, 200, {0, 0, -60}, {0, 0, 1}, {20, 90, 200}));
  make_survey(cloud);
  return cloud;
}

class PickSurfel : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("pick_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
             std::to_string(::getpid()) + ".surf");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  model::ModelFile model_of(const surfel::SurfelCloud& cloud) {
    EXPECT_TRUE(model::write_model(cloud, path_, {}));
    Result<model::ModelFile> model = model::ModelFile::open(path_);
    EXPECT_TRUE(model);
    return std::move(*model);
  }

  static kinds::PickQuery query_at(double x, double y, const geometry::Camera& camera, int width = 320,
                                   int height = 240) {
    return {*geometry::make_camera_frame(camera, width, height), {x, y}, {}, {}};
  }

  static std::optional<kinds::PickedSurfel> pick(const model::ModelFile& model, const kinds::PickQuery& query) {
    const std::atomic<bool> no{false};
    SourceBlocks blocks(0);
    Result<std::optional<kinds::PickedSurfel>> picked = pick_surfel(model, query, blocks, no);
    EXPECT_TRUE(picked) << (picked ? "" : picked.error().message);
    return picked ? *picked : std::nullopt;
  }

  std::filesystem::path path_;
};

geometry::Camera oblique() {
  return {kUtm.offset + glm::dvec3(150, -260, 120), kUtm.offset, {0, 0, 1}, 35};
}

/// The decoded leaves of a model.
std::vector<model::DecodedBlock> leaves_of(const model::ModelFile& model) {
  std::vector<model::DecodedBlock> leaves;
  for (size_t b = 0; b < model.blocks().size(); ++b) {
    if (model.blocks()[b].level == 0) leaves.push_back(*model.decode(b));
  }
  return leaves;
}

/// Tests all surfels of the finest level with the discs of the reference renderer. Returns the position of the surfel
/// to be picked.
std::optional<glm::dvec3> brute_force(const std::vector<model::DecodedBlock>& leaves, const kinds::PickQuery& query) {
  const glm::dvec3 ray = query.frame.ray(query.pixel);
  struct Seen {
    double form;
    double depth;
    glm::dvec3 position;
  };
  std::vector<Seen> seen;
  double surface = std::numeric_limits<double>::infinity();
  for (const model::DecodedBlock& block : leaves) {
    const auto& classes = std::get<std::vector<uint8_t>>(block.scalars[1].values);
    const float widest = surfel::largest_drawn_radius(block.radii, block.scatter);
    for (size_t i = 0; i < block.size(); ++i) {
      const glm::dvec3 o = query.frame.to_camera(block.position(i));
      const glm::dvec3 n = block.is_scatter(i) ? -glm::normalize(o) : query.frame.rotate(glm::dvec3(block.normals[i]));
      if (glm::dot(n, o) >= 0 || query.hidden_classes[classes[i]] || !query.clip.shows(block.position(i))) continue;
      const double radius = std::min(block.radii[i], widest);
      // With the visibility prefilter, the quadratic form of the filter is that of the disc.
      reference::KernelParameters disc;
      disc.sigma = disc.visibility_radius;
      const auto splat = reference::Splat::make(o, n, radius, query.frame.eta, disc.visibility_pixels, disc);
      const auto opaque = reference::Splat::make(o, n, radius, query.frame.eta, 1, {});
      if (!opaque || !splat || !opaque->opaque(ray)) continue;
      surface = std::min(surface, opaque->disc_depth(ray).pushed);
      seen.push_back({splat->fragment(ray).r2, opaque->fragment_depth(ray), block.position(i)});
    }
  }
  const Seen* best = nullptr;
  for (const Seen& s : seen) {
    if (s.depth <= surface && (best == nullptr || s.form < best->form)) best = &s;
  }
  return best == nullptr ? std::nullopt : std::optional(best->position);
}

/// Compares picks all over the picture with brute_force and counts the hits.
int compare(const model::ModelFile& model, const geometry::Clip& clip, const std::bitset<256>& hidden,
            const geometry::Camera& camera) {
  const std::vector<model::DecodedBlock> leaves = leaves_of(model);
  int hits = 0;
  SourceBlocks blocks(size_t{1} << 20);  // room for some blocks
  for (int y = 5; y < 240; y += 23) {
    for (int x = 3; x < 320; x += 29) {
      kinds::PickQuery query{*geometry::make_camera_frame(camera, 320, 240), {x + 0.5, y + 0.5}, clip, hidden};
      const std::atomic<bool> no{false};
      const auto picked = pick_surfel(model, query, blocks, no);
      const auto expected = brute_force(leaves, query);
      EXPECT_TRUE(picked);
      EXPECT_EQ((*picked).has_value(), expected.has_value()) << x << ' ' << y;
      if (!expected || !*picked) continue;
      EXPECT_EQ((*picked)->position, *expected) << x << ' ' << y;
      ++hits;
    }
  }
  return hits;
}

TEST_F(PickSurfel, FindsWhatASearchOverAllSurfelsFinds) {
  const model::ModelFile model = model_of(survey());
  ASSERT_GT(model.blocks().size(), 2u);
  EXPECT_GT(compare(model, {}, {}, oblique()), 40);
}

TEST_F(PickSurfel, FindsTheSameWithinTheScene) {
  surfel::SurfelCloud cloud = survey();
  cloud.oriented = true;
  const model::ModelFile model = model_of(cloud);
  const geometry::Camera low{kUtm.offset + glm::dvec3(60, 60, -58), kUtm.offset + glm::dvec3(0, 0, -50), {0, 0, 1}, 80};
  EXPECT_GT(compare(model, {}, {}, low), 30);
}

TEST_F(PickSurfel, ScatterIsPickedFromAllSidesAsItIsDrawn) {
  surfel::SurfelCloud cloud = survey();
  for (size_t i = 0; i < cloud.size(); ++i) cloud.scatter.push_back(i % 3 == 0 ? 1 : 0);
  const model::ModelFile model = model_of(cloud);
  EXPECT_GT(compare(model, {}, {}, oblique()), 40);
  const geometry::Camera inside{kUtm.offset, kUtm.offset + glm::dvec3(1, 0.3, 0.2), {0, 0, 1}, 60};
  EXPECT_GT(compare(model, {}, {}, inside), 10) << "the discs of the sphere show their backs";
}

TEST_F(PickSurfel, AStrayFacesTheEyeAndKeepsItsNormal) {
  surfel::SurfelCloud cloud = testing::single_surfel({0, 0, 0}, {0, 0, 1}, 1, {1, 2, 3});
  const kinds::PickQuery side = query_at(160.5, 120.5, {{0, -50, 0}, {0, 0, 0}, {0, 0, 1}, 5});
  const kinds::PickQuery edge = query_at(160.5, 100.5, {{0, -50, 0}, {0, 0, 0}, {0, 0, 1}, 5});
  EXPECT_FALSE(pick(model_of(cloud), edge)) << "a disc is seen from its edge";
  cloud.scatter = {1};
  const model::ModelFile model = model_of(cloud);
  ASSERT_TRUE(pick(model, side));
  const std::optional<kinds::PickedSurfel> picked = pick(model, edge);
  ASSERT_TRUE(picked);
  EXPECT_NEAR(glm::dot(picked->normal, glm::dvec3(0, 0, 1)), 1, 1e-6);
}

TEST_F(PickSurfel, ClipsAndHiddenClassesAreLookedThrough) {
  const model::ModelFile model = model_of(survey());
  geometry::Clip clip;
  clip.inside.push_back({kUtm.offset - glm::dvec3(90, 90, 70), kUtm.offset + glm::dvec3(90, 90, 20)});
  clip.outside.push_back({kUtm.offset - glm::dvec3(15, 50, 50), kUtm.offset + glm::dvec3(15, 50, 50)});
  std::bitset<256> hidden;
  hidden.set(2);
  EXPECT_GT(compare(model, clip, hidden, oblique()), 20);
}

TEST_F(PickSurfel, TheAnswerIsTheSourcePointWithAllItsAttributes) {
  const surfel::SurfelCloud cloud = survey();
  const model::ModelFile model = model_of(cloud);
  const auto picked = pick(model, query_at(160.5, 120.5, oblique()));
  ASSERT_TRUE(picked);
  ASSERT_EQ(picked->values.size(), 3u);
  EXPECT_EQ(picked->values[0].attribute, "intensity");
  EXPECT_EQ(picked->values[2].attribute, "gps_time");
  const auto i = static_cast<size_t>((picked->values[2].value - 1e5) / 0.125);
  ASSERT_LT(i, cloud.size());
  EXPECT_EQ(picked->position, cloud.positions[i]) << "to the last bit";
  EXPECT_EQ(picked->values[0].value, static_cast<double>(i));
  EXPECT_EQ(picked->values[1].value, static_cast<double>(i % 3 + 2));
  EXPECT_EQ(picked->color, glm::u8vec3(200, 90, 20));
  EXPECT_NEAR(picked->radius, double{cloud.radii[i]}, 1e-3 * double{cloud.radii[i]});
  EXPECT_GT(glm::dot(picked->normal, glm::dvec3(cloud.normals[i])), 0.9999);
  EXPECT_NEAR(picked->distance, glm::length(cloud.positions[i] - oblique().position), 1e-9);
}

TEST_F(PickSurfel, TheBackgroundIsNoSurfel) {
  const model::ModelFile model = model_of(survey());
  EXPECT_FALSE(pick(model, query_at(0.5, 0.5, oblique())));
  kinds::PickQuery hidden = query_at(160.5, 120.5, oblique());
  hidden.hidden_classes.set();
  EXPECT_FALSE(pick(model, hidden)) << "every class is hidden";
  kinds::PickQuery clipped = query_at(160.5, 120.5, oblique());
  clipped.clip.inside.push_back({kUtm.offset + 1000.0, kUtm.offset + 1001.0});
  EXPECT_FALSE(pick(model, clipped));
}

TEST_F(PickSurfel, BackFacesOfOrientedModelsAreNotPickedAndOthersFaceTheEye) {
  surfel::SurfelCloud cloud = testing::square(50, 2, {0, 0, 0}, {0, 0, -1}, {1, 2, 3});
  const kinds::PickQuery query = query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30});
  EXPECT_FALSE(pick(model_of(cloud), query));
  cloud.oriented = false;
  const auto picked = pick(model_of(cloud), query);
  ASSERT_TRUE(picked);
  EXPECT_GT(picked->normal.z, 0.99);
}

TEST_F(PickSurfel, OfCoincidentSurfacesTheNearerIsPicked) {
  surfel::SurfelCloud cloud = testing::square(100, 2, {0, 0, -0.5}, {0, 0, 1}, {9, 9, 9});
  testing::append(cloud, testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {1, 2, 3}));
  const auto picked = pick(model_of(cloud), query_at(150.5, 130.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30}));
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->color, glm::u8vec3(1, 2, 3));
}

TEST_F(PickSurfel, ColorsOfSixteenBitsAreRounded) {
  surfel::SurfelCloud cloud = testing::square(50, 2, {0, 0, 0}, {0, 0, 1}, {0, 0, 0});
  cloud.colors->bits = 16;
  for (glm::u16vec3& color : cloud.colors->values) color = {65535, 257 * 7, 128};
  const auto picked = pick(model_of(cloud), query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30}));
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->color, glm::u8vec3(255, 7, 0));
}

/// A wall of glass (class 6) at z = 0 before one of stone (class 2) at z = -0.5. Discs of an even sampling cover a
/// point two to five times, 3.66 times on average: opacities of the cases are far enough from one half.
surfel::SurfelCloud glass_before_stone() {
  surfel::SurfelCloud cloud = testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {1, 2, 3});
  std::vector<uint8_t> classes(cloud.size(), 6);
  testing::append(cloud, testing::square(100, 2, {0, 0, -0.5}, {0, 0, 1}, {9, 9, 9}));
  classes.resize(cloud.size(), 2);
  cloud.scalars = {{"classification", classes}};
  return cloud;
}

/// z of what is picked in the middle; none without.
std::optional<double> height_of(const std::optional<kinds::PickedSurfel>& picked) {
  return picked ? std::optional(picked->position.z) : std::nullopt;
}

TEST_F(PickSurfel, WhatLetsMostLightThroughIsPickedThrough) {
  const model::ModelFile model = model_of(glass_before_stone());
  kinds::PickQuery query = query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30});
  query.transparent = true;
  query.class_opacities.assign(256, 1);
  query.class_opacities[6] = 0.2;
  EXPECT_EQ(height_of(pick(model, query)), -0.5) << "glass of class 6";
  query.class_opacities[6] = 0.9;
  EXPECT_EQ(height_of(pick(model, query)), 0);
  query.class_opacities.clear();
  query.opacity = 0.1;
  EXPECT_FALSE(pick(model, query)) << "two walls that let 0.81 through";
  query.opacity = 0.9;
  EXPECT_EQ(height_of(pick(model, query)), 0);
}

TEST_F(PickSurfel, GhostsArePickedThroughAndStandBeforeTheBackground) {
  const model::ModelFile model = model_of(glass_before_stone());
  kinds::PickQuery query = query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30});
  query.transparent = true;
  query.clip.outside.push_back({{-2, -2, -0.1}, {2, 2, 0.1}});
  query.ghost = 0.1;
  EXPECT_EQ(height_of(pick(model, query)), -0.5);
  query.ghost = 0.95;
  EXPECT_EQ(height_of(pick(model, query)), 0);
}

TEST_F(PickSurfel, OpacitiesOfTheFileCount) {
  surfel::SurfelCloud cloud = glass_before_stone();
  std::vector<uint8_t> alpha(cloud.size() / 2, 40);
  alpha.resize(cloud.size(), 255);
  cloud.scalars = {{"alpha", alpha}};
  const model::ModelFile model = model_of(cloud);
  kinds::PickQuery query = query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30});
  query.transparent = query.by_file = true;
  EXPECT_EQ(height_of(pick(model, query)), -0.5);
  query.by_file = false;
  EXPECT_EQ(height_of(pick(model, query)), 0);
}

TEST_F(PickSurfel, TheFarSideOfAShellIsPicked) {
  surfel::SurfelCloud shell = testing::fibonacci_sphere(20000, 1, {0, 0, 0}, {1, 2, 3});
  std::vector<uint8_t> classes;
  for (const glm::dvec3& p : shell.positions) classes.push_back(p.z > 0 ? 6 : 2);
  shell.scalars = {{"classification", classes}};
  kinds::PickQuery query = query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30});
  query.transparent = true;
  query.class_opacities.assign(256, 1);
  query.class_opacities[6] = 0.2;
  const auto picked = pick(model_of(shell), query);
  ASSERT_TRUE(picked);
  EXPECT_NEAR(picked->position.z, -1, 0.01);
}

TEST_F(PickSurfel, ACancelledPickStops) {
  const model::ModelFile model = model_of(survey());
  const std::atomic<bool> yes{true};
  SourceBlocks blocks(0);
  EXPECT_EQ(pick_surfel(model, query_at(160.5, 120.5, oblique()), blocks, yes).error().kind, ErrorKind::kCancelled);
}

TEST_F(PickSurfel, BlocksAreDecodedOnceWithinTheBudget) {
  const model::ModelFile model = model_of(survey());
  ASSERT_GT(model.blocks().size(), 1U);
  SourceBlocks blocks(size_t{1} << 30);
  const auto first = *blocks.get(model, 1);
  EXPECT_EQ(*blocks.get(model, 1), first);
  EXPECT_GT(first->bytes(), size_t{32} * model.blocks()[1].items);
  SourceBlocks none(1000);
  EXPECT_NE(*none.get(model, 1), *none.get(model, 1)) << "a block of some hundred kilobytes";
}

/// A pixel of a picture of one pixel is as wide as the view.
TEST_F(PickSurfel, APixelAsWideAsTheModelIsRefused) {
  const model::ModelFile model = model_of(survey());
  const std::atomic<bool> no{false};
  SourceBlocks blocks(0);
  geometry::Camera wide = oblique();
  wide.view_angle = 179.9;
  const auto refused = pick_surfel(model, query_at(0.5, 0.5, wide, 1, 1), blocks, no, /*most_blocks=*/1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kLimit);
}

TEST_F(PickSurfel, OfAJoinedModelNamesTheMemberAndLeavesOutHiddenOnes) {
  surfel::SurfelCloud near = testing::square(50, 100, {0, 0, 30}, {0, 0, 1}, {255, 0, 0});
  surfel::SurfelCloud far = testing::square(50, 100, {0, 0, 0}, {0, 0, 1}, {0, 0, 255});
  far.scalars = {{"classification", std::vector<uint8_t>(far.size(), 6)}};
  near.colors.reset();
  const auto front = std::make_shared<const model::ModelFile>(model_of(near));
  const auto back = std::make_shared<const model::ModelFile>(model_of(far));
  const Result<model::ModelFile> joined = model::ModelFile::join({{"front", front}, {"back", back}});
  ASSERT_TRUE(joined);
  kinds::PickQuery query = query_at(160, 120, {{0, 0, 200}, {0, 0, 0}, {0, 1, 0}, 30});

  const auto first = pick(*joined, query);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->member, 0U);
  EXPECT_NEAR(first->position.z, 30, 0.1);
  EXPECT_FALSE(first->color) << "it has the grey of a joined model, which is no colour of the scan";
  EXPECT_TRUE(first->values.empty());
  EXPECT_EQ(first->number, pick(*front, query)->number);

  query.hidden_members = {true, false};
  const auto second = pick(*joined, query);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->member, 1U);
  EXPECT_EQ(second->color, glm::u8vec3(0, 0, 255));
  ASSERT_EQ(second->values.size(), 1U);
  EXPECT_EQ(second->values[0].value, 6);
  query.hidden_members = {};
  EXPECT_EQ(second->number, near.size() + pick(*back, query)->number) << "numbers go on from member to member";
  EXPECT_FALSE(pick(*back, query)->member);

  query.hidden_members = {true, true};
  EXPECT_FALSE(pick(*joined, query));
}

TEST_F(PickSurfel, OfAJoinedModelOnlyTheBacksOfScansWithoutFrontsArePicked) {
  const auto away =
      std::make_shared<const model::ModelFile>(model_of(testing::square(50, 2, {0, 0, 1}, {0, 0, -1}, {255, 0, 0})));
  surfel::SurfelCloud two_sided = testing::square(50, 2, {0, 0, 0}, {0, 0, -1}, {0, 0, 255});
  two_sided.oriented = false;
  const auto sides = std::make_shared<const model::ModelFile>(model_of(two_sided));
  const Result<model::ModelFile> joined = model::ModelFile::join({{"away", away}, {"sides", sides}});
  ASSERT_TRUE(joined);
  const auto picked = pick(*joined, query_at(160.5, 120.5, {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30}));
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->member, 1U);
  EXPECT_GT(picked->normal.z, 0.99) << "it is turned towards the eye";
}

}  // namespace
}  // namespace surfcast::pick
