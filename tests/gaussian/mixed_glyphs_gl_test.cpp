// Ellipsoids beside Gaussians, volumes and surfels that are seen through: what is in front hides what is behind.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "gaussian/mixed_scene_fixture.h"

namespace surfcast::gaussian {
namespace {

using testing::draw;

class GlyphsAmongOthersGL : public testing::MixedSceneFixture {
 protected:
  /// Linear light of the middle.
  static glm::dvec3 middle_of(const picture::Image& image) {
    glm::vec4 p;
    const size_t middle = (size_t{kSide} / 2) * kSide + kSide / 2;
    std::memcpy(&p, image.pixels.data() + sizeof(p) * middle, sizeof(p));
    return {p};
  }

  static void expect_light(const picture::Image& image, const glm::dvec3& expected, double error,
                           const std::string& what) {
    const glm::dvec3 found = middle_of(image);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], error) << what << ' ' << c;
  }
};

TEST_F(GlyphsAmongOthersGL, HideAndAreHiddenByGaussiansAsTrained) {
  picture::PictureRequest request = request_of();
  const reference::LightPicture alone =
      reference::draw_as_trained((splat(), splats_), frame(), reference::GaussianConvention::kTrained);
  const glm::dvec4 seen = alone.pixels[alone.index(kSide / 2, kSide / 2)];
  ASSERT_GT(seen.w, 0.7);
  // Programs that train Gaussians blend codes.
  expect_light(picture_of({glyph(-0.5), splat()}, request),
               reference::linear_from_srgb(glm::dvec3(seen) + (1 - seen.w) * kGlyph), 0.01, "behind");
  expect_light(picture_of({glyph(0.5), splat()}, request), reference::linear_from_srgb(kGlyph), 0.005, "in front");
}

TEST_F(GlyphsAmongOthersGL, CutExactGaussiansWhereTheyStand) {
  const reference::LightPicture alone = reference::draw_exactly((splat(), splats_), frame());
  const double alpha = alone.pixels[alone.index(kSide / 2, kSide / 2)].w;
  for (const double z : {-1.2, -0.3, -0.1, 0.0, 0.15, 0.45}) {
    const double share = alpha * 0.5 * std::erfc(z / kDeviation / std::sqrt(2.0));
    expect_light(picture_of({glyph(z), splat()}, request_of(picture::SplatConvention::kExact)),
                 reference::linear_from_srgb(share * kSplat + (1 - share) * kGlyph), 0.012, number(z));
  }
}

TEST_F(GlyphsAmongOthersGL, StandInVolumesWhereTheyAre) {
  picture::PictureRequest request = request_of();
  request.volumes.transfer.points = {{0, kCube, kCubeOpacity}, {255, kCube, kCubeOpacity}};
  request.volumes.transfer.spacing = 1;
  for (const double z : {-1.5, -0.7, 0.0, 0.4, 1.2}) {
    const double through = std::pow(1 - kCubeOpacity, 1 - std::clamp(z, -1.0, 1.0));
    const glm::dvec3 expected =
        (1 - through) * reference::linear_from_srgb(kCube) + through * reference::linear_from_srgb(kGlyph);
    for (const bool motion : {false, true}) {
      request.blends_behind = motion;
      expect_light(picture_of({cube(), glyph(z)}, request), expected, 5e-3, number(z));
    }
  }
}

TEST_F(GlyphsAmongOthersGL, CountInTheTimesOfProjectionAndListsBesideVolumes) {
  // Volumes have neither, so all of the time is that of the glyph.
  const picture::Frame frame = draw(*renderer_, build({cube(), glyph(0)}), request_of());
  EXPECT_EQ(frame.stats.surfels_drawn, 1U);
  for (const char* name : {"project", "bin", "splat"}) {
    const auto stage = std::ranges::find(frame.stats.stages, name, &picture::StageTime::name);
    ASSERT_NE(stage, frame.stats.stages.end()) << name;
    EXPECT_GT(stage->milliseconds, 0) << name;
  }
}

TEST_F(GlyphsAmongOthersGL, AreSeenThroughTransparentSurfels) {
  picture::PictureRequest request = request_of();
  request.class_opacities = {{5, 0.4}};
  const glm::dvec3 mixed = 0.4 * reference::linear_from_srgb(kPlane) + 0.6 * reference::linear_from_srgb(kGlyph);
  expect_light(picture_of({plane(0.3), glyph(0)}, request), mixed, 0.012, "behind");
  expect_light(picture_of({plane(-0.3), glyph(0)}, request), reference::linear_from_srgb(kGlyph), 0.005, "in front");
}

TEST_F(GlyphsAmongOthersGL, AreSeenThroughTransparentSurfelsInVolumes) {
  picture::PictureRequest request = request_of();
  request.class_opacities = {{5, 0.4}};
  request.volumes.transfer.points = {{0, kCube, kCubeOpacity}, {255, kCube, kCubeOpacity}};
  request.volumes.transfer.spacing = 1;
  const double before = std::pow(1 - kCubeOpacity, 0.7);   // from 1 to 0.3
  const double between = std::pow(1 - kCubeOpacity, 0.5);  // to -0.2
  const glm::dvec3 behind =
      (1 - between) * reference::linear_from_srgb(kCube) + between * reference::linear_from_srgb(kGlyph);
  const glm::dvec3 expected = (1 - before) * reference::linear_from_srgb(kCube) +
                              before * (0.4 * reference::linear_from_srgb(kPlane) + 0.6 * behind);
  expect_light(picture_of({cube(), plane(0.3), glyph(-0.2)}, request), expected, 0.012, "all of them");
}

}  // namespace
}  // namespace surfcast::gaussian
