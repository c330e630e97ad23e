#include <atomic>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <memory>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "ellipsoid/tensor_fields.h"
#include "model/test_folder.h"
#include "pick/front_surface.h"
#include "pick/pick_surfel.h"

namespace surfcast::pick {
namespace {

constexpr int kSide = 33;  // odd: a ray through the middle

double value_of(const kinds::PickedSurfel& picked, const std::string& name) {
  for (const kinds::PickedValue& value : picked.values) {
    if (value.attribute == name) return value.value;
  }
  ADD_FAILURE() << "no value " << name;
  return NAN;
}

class PickEllipsoidsTest : public ::testing::Test {
 protected:
  model::ModelFile build(const std::filesystem::path& input) {
    const auto built = builder::build_model({{input}}, folder_ / "model.surf", {}, [](const builder::BuildStep&) {});
    EXPECT_TRUE(built) << (built ? "" : built.error().message);
    Result<model::ModelFile> model = model::ModelFile::open(folder_ / "model.surf");
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return std::move(*model);
  }
  model::ModelFile table(const std::string& rows) {
    std::ofstream(folder_ / "t.csv") << "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue,score\n" << rows;
    return build(folder_ / "t.csv");
  }
  static kinds::PickQuery query(const glm::dvec3& from, const glm::dvec3& at) {
    const geometry::Camera camera{from, at, {0, 1, 0}, 30};
    return {*geometry::make_camera_frame(camera, kSide, kSide), glm::dvec2(0.5 * kSide), {}, {}};
  }
  static std::optional<kinds::PickedSurfel> pick(const model::ModelFile& model, const kinds::PickQuery& query) {
    SourceBlocks blocks(1 << 20);
    const std::atomic<bool> never{false};
    const auto picked = pick_surfel(model, query, blocks, never);
    EXPECT_TRUE(picked) << (picked ? "" : picked.error().message);
    return picked ? *picked : std::nullopt;
  }
  static std::shared_ptr<const std::vector<kinds::GlyphSight>> sights(const kinds::GlyphSight& sight) {
    return std::make_shared<const std::vector<kinds::GlyphSight>>(1, sight);
  }

  model::TestFolder folder_;
};

TEST_F(PickEllipsoidsTest, TheNearestHitOfTheRayIsPickedWithItsRow) {
  const model::ModelFile model = table(
      "0,0,0,2,1,0.5,1,0,0,0,255,128,0,7\n"
      "0,0,3,0.25,0.125,0.0625,0,1,0,0,0,0,255,8\n"
      "1,0,3.5,0.25,0.125,0.0625,1,0,0,0,0,0,255,9\n");
  const auto nearest = pick(model, query({0, 0, 10}, {0, 0, 0}));
  ASSERT_TRUE(nearest);
  EXPECT_EQ(value_of(*nearest, "score"), 8);
  EXPECT_NEAR(nearest->depth, 7 - 0.0625, 1e-5);
  EXPECT_NEAR(nearest->normal.z, 1, 1e-9);
  EXPECT_EQ(*nearest->color, glm::u8vec3(0, 0, 255));
  EXPECT_NEAR(value_of(*nearest, "semi_axis_1"), 0.25, 1e-5);
  EXPECT_NEAR(std::abs(value_of(*nearest, "axis_1_x")), 1, 1e-9);
  const auto behind = pick(model, query({0, 0.5, 10}, {0, 0.5, 0}));
  ASSERT_TRUE(behind);
  EXPECT_EQ(value_of(*behind, "score"), 7);
  EXPECT_NEAR(behind->depth, 10 - 0.5 * std::sqrt(0.75), 1e-5) << "where the ray meets it, not its centre";
  EXPECT_FALSE(pick(model, query({0, 1.5, 10}, {0, 1.5, 0}))) << "beside it";
}

TEST_F(PickEllipsoidsTest, ASampleOfAFieldGivesItsIndicesTensorAndExactPosition) {
  const model::ModelFile model = build(surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 9));
  // The sample (4, 4, 8) is on top of the ball.
  const auto top = pick(model, query({8, 8, 40}, {8, 8, 16}));
  ASSERT_TRUE(top);
  EXPECT_EQ(top->position, glm::dvec3(8, 8, 16));
  EXPECT_EQ(value_of(*top, "i"), 4);
  EXPECT_EQ(value_of(*top, "j"), 4);
  EXPECT_EQ(value_of(*top, "k"), 8);
  const ellipsoid::SymmetricTensor wanted = surfcast::testing::made_tensor({0, 0, 1});
  EXPECT_NEAR(value_of(*top, "tensor_xx"), wanted.xx, 1e-7);
  EXPECT_NEAR(value_of(*top, "tensor_xy"), wanted.xy, 1e-7);
  EXPECT_NEAR(value_of(*top, "tensor_zz"), 0.002, 1e-7);
  EXPECT_NEAR(value_of(*top, "eigenvalue_1"), 0.004, 1e-7);
  EXPECT_NEAR(std::abs(value_of(*top, "eigenvector_1_x")), std::abs(std::cos(3.0)), 1e-5);
  EXPECT_NEAR(value_of(*top, "fa"), ellipsoid::fractional_anisotropy({0.004, 0.002, 0.001}), 1e-4);
  EXPECT_EQ(value_of(*top, "confidence"), 1);
  EXPECT_NEAR(top->radius, 1, 1e-3) << "half a step";
  EXPECT_NEAR(top->depth, 24 - 0.5, 1e-3) << "the vertical semi-axis is half of the longest";
}

TEST_F(PickEllipsoidsTest, WhatThePictureHidesIsNotPicked) {
  const model::ModelFile model = build(surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 9));
  kinds::PickQuery hidden = query({8, 8, 40}, {8, 8, 16});
  kinds::GlyphSight sight;
  sight.scale = model.ellipsoid_sources()[0].scale();
  sight.ranges = {{0, 0.9, 1}};
  hidden.glyphs = sights(sight);
  EXPECT_FALSE(pick(model, hidden)) << "none has such a fractional anisotropy";
  sight.ranges = {{-1, 0, 1}};
  hidden.glyphs = sights(sight);
  EXPECT_FALSE(pick(model, hidden)) << "none has the attribute";
  sight.ranges.clear();
  sight.layers = {{{0, 0, 4}, {0, 0, 0.5}}};
  hidden.glyphs = sights(sight);
  const auto layer = pick(model, hidden);
  ASSERT_TRUE(layer);
  EXPECT_EQ(value_of(*layer, "k"), 2);
}

TEST_F(PickEllipsoidsTest, GlyphsAreAsLargeAsThePictureDrawsThem) {
  const model::ModelFile model = table("0,0,0,1,0.25,0.25,1,0,0,0,255,128,0,7\n");
  kinds::PickQuery above = query({0, 0.9, 10}, {0, 0.9, 0});
  EXPECT_FALSE(pick(model, above));
  kinds::GlyphSight sight;
  sight.scale = 4;
  above.glyphs = sights(sight);
  above.reach = 4;
  EXPECT_TRUE(pick(model, above));
  sight.scale = 2;
  sight.measure = kinds::GlyphMeasure::kRoot;
  above.glyphs = sights(sight);
  const auto root = pick(model, above);
  ASSERT_TRUE(root) << "the root of a quarter is a half";
  EXPECT_NEAR(root->radius, 2, 1e-4);
  sight.measure = kinds::GlyphMeasure::kUnit;
  above.glyphs = sights(sight);
  EXPECT_FALSE(pick(model, above)) << "half a unit high";
}

TEST_F(PickEllipsoidsTest, EveryPixelShowsWhatAPickThereFinds) {
  const model::ModelFile model = build(surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 9));
  kinds::PickQuery all = query({30, 20, 40}, {8, 8, 8});
  SourceBlocks blocks(1 << 24);
  const std::atomic<bool> never{false};
  const auto front = find_front_surface(model, all, blocks, never);
  ASSERT_TRUE(front) << front.error().message;
  int hits = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      all.pixel = {x + 0.5, y + 0.5};
      const auto picked = pick(model, all);
      const FrontPixel& pixel = (*front)[static_cast<size_t>(y * kSide + x)];
      ASSERT_EQ(picked.has_value(), pixel.number != FrontPixel::kBackground) << x << " " << y;
      if (!picked) continue;
      ++hits;
      EXPECT_EQ(picked->number, pixel.number);
      EXPECT_NEAR(picked->depth, pixel.depth, 1e-9);
      EXPECT_NEAR(glm::distance(picked->normal, glm::dvec3(pixel.normal)), 0, 1e-6);
    }
  }
  EXPECT_GT(hits, 100);
}

}  // namespace
}  // namespace surfcast::pick
