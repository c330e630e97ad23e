// Pictures of ellipsoids by the GPU, beside exact samples in double precision under the same prefilter.

#include <array>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "glyphs/glyph_scenes.h"
#include "model/test_folder.h"

namespace surfcast {
namespace {

struct Goal {
  const char* scene;
  double rest;  ///< dB
};

class GlyphAccuracy : public ::testing::TestWithParam<Goal> {
 protected:
  static void SetUpTestSuite() { renderer_ = testing::make_renderer(); }
  static void TearDownTestSuite() { renderer_.reset(); }

  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
};

TEST_P(GlyphAccuracy, PicturesAreNearTheIdeal) {
  const auto [name, rest] = GetParam();
  const reference::EllipsoidScene scene = reference::make_ellipsoid_scene(name);
  const auto model = testing::write_glyphs(folder_ / "glyphs.surf", scene.glyphs);
  const auto frame = *geometry::make_camera_frame(scene.camera, scene.side, scene.side);
  const auto ideal = encode(reference::ellipsoid_picture(testing::stored_glyphs(*model), frame, 8));
  std::array<double, 2> decibels{};
  for (const bool motion : {false, true}) {
    const auto request = testing::glyph_request(scene.camera, scene.side, motion);
    const auto drawn = testing::codes_of(testing::draw(*renderer_, model, request).image);
    decibels.at(motion ? 1 : 0) = psnr(drawn, ideal);
    if (const char* folder = std::getenv("SURFCAST_TEST_PICTURES")) {
      const std::string base = std::string(folder) + "/glyphs_" + name;
      write_ppm(base + (motion ? "_motion.ppm" : "_rest.ppm"), drawn);
      write_ppm(base + "_ideal.ppm", ideal);
    }
  }
  RecordProperty("rest", std::to_string(decibels[0]));
  std::cout << name << ": " << decibels[0] << " dB at rest, " << decibels[1] << " in motion\n";
  EXPECT_GE(decibels[0], rest);
  EXPECT_GE(decibels[1], decibels[0] - 9);
}

INSTANTIATE_TEST_SUITE_P(Scenes, GlyphAccuracy,
                         ::testing::Values(Goal{"helix", 48}, Goal{"mixed", 48}, Goal{"needles", 38},
                                           Goal{"extreme", 44}, Goal{"overlap", 54}, Goal{"close", 54},
                                           Goal{"far", 38}),
                         [](const auto& goal) { return std::string(goal.param.scene); });

}  // namespace
}  // namespace surfcast
