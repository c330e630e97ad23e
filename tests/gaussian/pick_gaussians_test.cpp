#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "pick/front_surface.h"
#include "pick/pick_surfel.h"

namespace surfcast::pick {
namespace {

using testing::ModelPointer;

constexpr int kSide = 33;  // odd: a ray through the middle

reference::GaussianSplat splat_at(double z, double opacity) {
  reference::GaussianSplat splat;
  splat.position = {0, 0, z};
  splat.log_scale = glm::dvec3(std::log(0.1));
  splat.logit = std::log(opacity / (1 - opacity));
  return splat;
}

class PickGaussiansTest : public ::testing::Test {
 protected:
  ModelPointer build(const std::vector<reference::GaussianSplat>& splats) {
    return testing::build_and_open(testing::write_ply(folder_ / "model.ply", {splats, 0}), folder_ / "model.surf");
  }
  [[nodiscard]] static kinds::PickQuery query() {
    const geometry::Camera camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30};
    return {*geometry::make_camera_frame(camera, kSide, kSide), glm::dvec2(0.5 * kSide), {}, {}};
  }
  static std::optional<kinds::PickedSurfel> pick(const ModelPointer& model, const kinds::PickQuery& query) {
    SourceBlocks blocks(1 << 20);
    const std::atomic<bool> never{false};
    const auto picked = pick_surfel(*model, query, blocks, never);
    EXPECT_TRUE(picked) << (picked ? "" : picked.error().message);
    return picked ? *picked : std::nullopt;
  }

  model::TestFolder folder_;
};

TEST_F(PickGaussiansTest, ARaySeesTheOneThatTakesHalfOfTheLight) {
  // Before it the eye sees through: 0.4 leaves 0.6 of the light.
  const auto second = pick(build({splat_at(2, 0.4), splat_at(1, 0.6), splat_at(0, 0.98)}), query());
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->position.z, 1, 1e-3);
  EXPECT_NEAR(second->depth, 4, 1e-3);
  const auto first = pick(build({splat_at(0, 0.98), splat_at(2, 0.7)}), query());
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->position.z, 2, 1e-3);
  EXPECT_FALSE(pick(build({splat_at(2, 0.2), splat_at(1, 0.2)}), query())) << "two thirds of the light pass";
}

TEST_F(PickGaussiansTest, TheOpacityOfThePictureLetsARaySeeFarther) {
  const ModelPointer model = build({splat_at(2, 0.8), splat_at(1, 0.8), splat_at(0, 0.8)});
  kinds::PickQuery faint = query();
  faint.opacity = 0.5;
  EXPECT_NEAR(pick(model, faint)->position.z, 1, 1e-3);
  faint.opacity = 0;
  EXPECT_FALSE(pick(model, faint));
}

TEST_F(PickGaussiansTest, ClippedOnesTakeNoLight) {
  kinds::PickQuery clipped = query();
  clipped.clip.outside.push_back({{-1, -1, 1.5}, {1, 1, 3}});
  const auto picked = pick(build({splat_at(2, 0.9), splat_at(1, 0.9)}), clipped);
  ASSERT_TRUE(picked);
  EXPECT_NEAR(picked->position.z, 1, 1e-3);
}

/// A square of points at z = 0 and Gaussians.
ModelPointer with_square(const model::TestFolder& folder, const std::vector<reference::GaussianSplat>& splats) {
  std::string text;
  for (int i = 0; i < 10000; ++i) {
    text += std::to_string(0.02 * (i % 100 - 50)) + " " + std::to_string(0.02 * (i / 100 - 50)) + " 0 200 100 50\n";
  }
  const std::array inputs{testing::write(folder / "square.xyz", text),
                          testing::write_ply(folder / "splats.ply", {splats, 0})};
  EXPECT_TRUE(builder::build_model(inputs, folder / "mixed.surf", {}, [](const builder::BuildStep&) {}));
  return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(folder / "mixed.surf")));
}

TEST_F(PickGaussiansTest, ASurfaceIsPickedThroughThoseThatTakeLessThanHalfOfTheLight) {
  const auto through = pick(with_square(folder_, {splat_at(2, 0.3), splat_at(-1, 0.98)}), query());
  ASSERT_TRUE(through);
  EXPECT_NEAR(through->depth, 5, 0.02);
  EXPECT_EQ(through->color, glm::u8vec3(200, 100, 50));
  const auto before = pick(with_square(folder_, {splat_at(2, 0.3), splat_at(1, 0.6), splat_at(-1, 0.98)}), query());
  ASSERT_TRUE(before);
  EXPECT_NEAR(before->depth, 4, 1e-3);
}

TEST_F(PickGaussiansTest, DepthsOfAllPixelsAreThoseOfPicksAmongSurfaces) {
  reference::GaussianModel many = reference::make_gaussian_model("fog");
  many.splats.resize(400);
  for (reference::GaussianSplat& splat : many.splats) splat.logit += 1.5;
  const ModelPointer model = with_square(folder_, many.splats);
  SourceBlocks blocks(1 << 20);
  const std::atomic<bool> never{false};
  const auto pixels = find_front_surface(*model, query(), blocks, never);
  ASSERT_TRUE(pixels);
  int surfaces = 0;
  int gaussians = 0;
  for (int i = 0; i < kSide * kSide; i += 5) {
    kinds::PickQuery here = query();
    here.pixel = glm::dvec2(i % kSide, i / kSide) + 0.5;
    const auto picked = pick(model, here);
    const FrontPixel& pixel = (*pixels)[static_cast<size_t>(i)];
    ASSERT_EQ(picked.has_value(), std::isfinite(pixel.depth)) << i;
    if (!picked) continue;
    EXPECT_EQ(picked->depth, pixel.depth) << i;
    EXPECT_EQ(picked->number, pixel.number) << i;
    ++(picked->position.z == 0 ? surfaces : gaussians);
  }
  EXPECT_GT(surfaces, 5);
  EXPECT_GT(gaussians, 5);
}

TEST_F(PickGaussiansTest, DepthsOfAllPixelsAreThoseOfPicks) {
  reference::GaussianModel many = reference::make_gaussian_model("fog");
  many.splats.resize(400);
  for (reference::GaussianSplat& splat : many.splats) splat.logit += 1.5;
  const ModelPointer model =
      testing::build_and_open(testing::write_ply(folder_ / "fog.ply", many), folder_ / "fog.surf");
  SourceBlocks blocks(1 << 20);
  const std::atomic<bool> never{false};
  const auto pixels = find_front_surface(*model, query(), blocks, never);
  ASSERT_TRUE(pixels);
  int shown = 0;
  for (int i = 0; i < kSide * kSide; i += 7) {
    kinds::PickQuery here = query();
    here.pixel = glm::dvec2(i % kSide, i / kSide) + 0.5;
    const auto picked = pick(model, here);
    const FrontPixel& pixel = (*pixels)[static_cast<size_t>(i)];
    ASSERT_EQ(picked.has_value(), std::isfinite(pixel.depth)) << i;
    if (!picked) continue;
    ++shown;
    EXPECT_EQ(picked->depth, pixel.depth) << i;
    EXPECT_EQ(picked->number, pixel.number) << i;
  }
  EXPECT_GT(shown, 10);
}

}  // namespace
}  // namespace surfcast::pick
