#include "pick/front_surface.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <random>

#include <gtest/gtest.h>
#include <unistd.h>

#include "kinds/opaque_disc.h"
#include "model/write_model.h"
#include "pick/leaf_numbers.h"
#include "pick/pick_surfel.h"
#include "support/clouds.h"

namespace surfcast::pick {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

const glm::dvec3 kUtmOrigin(1'048'262.25, 5'411'932.5, 312);

/// A sphere of two classes above a floor, so that there are silhouettes, and much is hidden.
surfel::SurfelCloud scene(const glm::dvec3& origin) {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(30000, 40, origin, {200, 90, 20});
  testing::append(cloud, testing::square(200, 200, origin - glm::dvec3(0, 0, 60), {0, 0, 1}, {20, 90, 200}));
  std::vector<uint8_t> classes;
  for (size_t i = 0; i < cloud.size(); ++i) classes.push_back(static_cast<uint8_t>(i % 3 + 2));
  cloud.scalars = {{"classification", classes}};
  return cloud;
}

class FrontSurface : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  model::ModelFile model_of(const surfel::SurfelCloud& cloud) {
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("front_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
             std::to_string(::getpid()) + ".surf");
    EXPECT_TRUE(model::write_model(cloud, path_, {}));
    Result<model::ModelFile> model = model::ModelFile::open(path_);
    EXPECT_TRUE(model);
    return std::move(*model);
  }

  std::filesystem::path path_;
};

kinds::PickQuery query_of(const geometry::Camera& camera, int width = kWidth, int height = kHeight) {
  return {*geometry::make_camera_frame(camera, width, height), {}, {}, {}};
}

std::vector<FrontPixel> search(const model::ModelFile& model, const kinds::PickQuery& query) {
  const std::atomic<bool> no{false};
  SourceBlocks blocks(0);
  Result<std::vector<FrontPixel>> front = find_front_surface(model, query, blocks, no);
  EXPECT_TRUE(front);
  return std::move(*front);
}

/// Whether a pixel is what a pick there finds.
void expect_picked(const FrontPixel& pixel, const std::optional<kinds::PickedSurfel>& picked, int x, int y) {
  ASSERT_EQ(pixel.number != FrontPixel::kBackground, picked.has_value()) << x << ' ' << y;
  if (!picked) {
    EXPECT_TRUE(std::isinf(pixel.depth));
    return;
  }
  EXPECT_EQ(pixel.number, picked->number) << x << ' ' << y;
  EXPECT_EQ(pixel.depth, picked->depth) << x << ' ' << y;
  EXPECT_EQ(pixel.normal, glm::vec3(picked->normal)) << x << ' ' << y;
  for (const kinds::PickedValue& value : picked->values) {
    if (value.attribute != "classification") continue;
    EXPECT_EQ(double{pixel.code}, value.value);
  }
}

/// Compares `count` random pixels with picks. Returns how many show a surfel.
int compare(const model::ModelFile& model, kinds::PickQuery query, int count) {
  const std::vector<FrontPixel> front = search(model, query);
  std::mt19937 random(5);
  SourceBlocks blocks(size_t{1} << 30);
  const std::atomic<bool> no{false};
  int hits = 0;
  for (int i = 0; i < count; ++i) {
    const int x = static_cast<int>(random() % static_cast<uint32_t>(query.frame.width));
    const int y = static_cast<int>(random() % static_cast<uint32_t>(query.frame.height));
    query.pixel = {x + 0.5, y + 0.5};
    const auto picked = pick_surfel(model, query, blocks, no);
    EXPECT_TRUE(picked);
    expect_picked(front[static_cast<size_t>(y) * static_cast<size_t>(query.frame.width) + static_cast<size_t>(x)],
                  *picked, x, y);
    hits += picked->has_value() ? 1 : 0;
  }
  return hits;
}

TEST_F(FrontSurface, IsWhatPicksFindInAThousandPixelsFarFromTheOrigin) {
  const model::ModelFile model = model_of(scene(kUtmOrigin));
  ASSERT_GT(model.blocks().size(), 2U);
  const geometry::Camera oblique{kUtmOrigin + glm::dvec3(150, -260, 120), kUtmOrigin, {0, 0, 1}, 35};
  EXPECT_GT(compare(model, query_of(oblique), 1000), 300);
}

TEST_F(FrontSurface, IsWhatPicksFindWithinTheScene) {
  const model::ModelFile model = model_of(scene(kUtmOrigin));
  const geometry::Camera low{kUtmOrigin + glm::dvec3(60, 60, -58), kUtmOrigin + glm::dvec3(0, 0, -50), {0, 0, 1}, 80};
  EXPECT_GT(compare(model, query_of(low), 1000), 300);
  surfel::SurfelCloud sides = scene(kUtmOrigin);
  sides.oriented = false;
  const geometry::Camera below{
      kUtmOrigin + glm::dvec3(3, 4, -61.5), kUtmOrigin + glm::dvec3(0, 0, -60), {0, 0, 1}, 120};
  EXPECT_GT(compare(model_of(sides), query_of(below), 1000), 100);
}

TEST_F(FrontSurface, LooksThroughClipsAndHiddenClasses) {
  const model::ModelFile model = model_of(scene(kUtmOrigin));
  kinds::PickQuery query = query_of({kUtmOrigin + glm::dvec3(150, -260, 120), kUtmOrigin, {0, 0, 1}, 35});
  query.clip.inside.push_back({kUtmOrigin - glm::dvec3(90, 90, 70), kUtmOrigin + glm::dvec3(90, 90, 20)});
  query.clip.outside.push_back({kUtmOrigin - glm::dvec3(15, 50, 50), kUtmOrigin + glm::dvec3(15, 50, 50)});
  query.hidden_classes.set(2);
  EXPECT_GT(compare(model, query, 1000), 100);
}

TEST_F(FrontSurface, LooksThroughWhatLetsMostLightThrough) {
  const model::ModelFile model = model_of(scene(kUtmOrigin));
  kinds::PickQuery query = query_of({kUtmOrigin + glm::dvec3(150, -260, 120), kUtmOrigin, {0, 0, 1}, 35});
  query.transparent = true;
  query.class_opacities.assign(256, 0.3);
  query.class_opacities[2] = 0.1;
  EXPECT_GT(compare(model, query, 300), 10) << "surfels of several sheets together";
  query.opacity = 0.9;
  query.class_opacities.clear();
  query.clip.outside.push_back({kUtmOrigin - glm::dvec3(50, 50, 50), kUtmOrigin + glm::dvec3(50, 50, 50)});
  query.ghost = 0.1;
  EXPECT_GT(compare(model, query, 300), 30) << "the floor behind a ghost";
}

TEST_F(FrontSurface, IsTheSameInPicturesOfSeveralRegions) {
  const model::ModelFile model = model_of(scene({0, 0, 0}));
  const kinds::PickQuery query = query_of({{150, -260, 120}, {0, 0, 0}, {0, 0, 1}, 35}, 1500, 1100);
  EXPECT_GT(compare(model, query, 200), 50);
}

// The tangent plane of the reference is exact. Surfels lie on it, so the error is that of their coded normals.
TEST_F(FrontSurface, OfAPlaneAtAGrazingAngleHasThePlanesDepth) {
  const model::ModelFile model = model_of(testing::square(400, 100, kUtmOrigin, {0, 0, 1}, {9, 9, 9}));
  const geometry::Camera grazing{kUtmOrigin + glm::dvec3(0, -70, 3), kUtmOrigin, {0, 0, 1}, 40};
  const kinds::PickQuery query = query_of(grazing);
  const std::vector<FrontPixel> front = search(model, query);
  const double spacing = 0.25;
  int compared = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const FrontPixel& pixel = front[static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)];
      const glm::dvec3 ray = query.frame.ray({x + 0.5, y + 0.5});
      const glm::dvec3 direction = query.frame.right * ray.x + query.frame.up * ray.y + query.frame.forward;
      const double depth = direction.z < 0 ? 3 / -direction.z : INFINITY;
      const glm::dvec3 at = query.frame.eye + depth * direction - kUtmOrigin;
      const bool within = std::max(std::abs(at.x), std::abs(at.y)) < 49;
      if (!within) continue;
      ++compared;
      ASSERT_NE(pixel.number, FrontPixel::kBackground) << x << ' ' << y;
      // The depth changes by depth^2 / (eta height) from row to row.
      const double row = depth * depth / (query.frame.eta * 3);
      EXPECT_NEAR(pixel.depth, depth, std::max(spacing, row)) << x << ' ' << y;
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST_F(FrontSurface, StopsWhenItIsCancelled) {
  const model::ModelFile model = model_of(scene({0, 0, 0}));
  const std::atomic<bool> yes{true};
  SourceBlocks blocks(0);
  const auto front = find_front_surface(model, query_of({{0, -260, 120}, {0, 0, 0}, {0, 0, 1}, 35}), blocks, yes);
  EXPECT_EQ(front.error().kind, ErrorKind::kCancelled);
}

TEST_F(FrontSurface, NumbersCountTheSurfelsOfTheLeaves) {
  const model::ModelFile model = model_of(scene({0, 0, 0}));
  const std::vector<uint64_t> numbers = leaf_numbers(model);
  uint64_t leaves = 0;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (model.tree().children(block).count > 0) continue;
    EXPECT_EQ(numbers[block], leaves);
    leaves += model.blocks()[block].items;
  }
  EXPECT_EQ(leaves, model.info().surfels);
}

// Every pixel that hit_disc covers lies in the range.
TEST(DiscPixels, ContainEveryPixelThatTheDiscCovers) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> even(-1, 1);
  geometry::CameraFrame frame = *geometry::make_camera_frame({{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60}, 60, 40);
  const kinds::PixelRange all{{0, 0}, {59, 39}};
  int covered = 0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 ray(0.9 * even(random), 0.7 * even(random), 1);
    const double depth = std::exp(3 * even(random));
    const double radius = 0.8 * depth * std::exp(3 * even(random) - 3);
    const glm::dvec3 n = glm::normalize(glm::dvec3(even(random), even(random), even(random)));
    const glm::dvec3 o = ray * depth + radius * glm::dvec3(even(random), even(random), even(random));
    const auto range = kinds::disc_pixels(o, n, radius, frame, all);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 60; ++x) {
        const auto hit = kinds::hit_disc(o, n, radius, frame.ray({x + 0.5, y + 0.5}), frame.eta);
        if (!hit) continue;
        ++covered;
        EXPECT_GE(hit->surface, kinds::nearest_depth(o, radius));
        ASSERT_TRUE(range && range->first.x <= x && x <= range->last.x && range->first.y <= y && y <= range->last.y)
            << i << ' ' << x << ' ' << y;
      }
    }
  }
  EXPECT_GT(covered, 5000);
}

}  // namespace
}  // namespace surfcast::pick
