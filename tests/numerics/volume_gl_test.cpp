// Volumes where levels and bricks meet, and at extreme opacities.

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "reference/volume_ray_caster.h"
#include "reference/volume_scenes.h"
#include "render/renderer.h"
#include "volume/grid_scene.h"
#include "volume/volume_pictures.h"
#include "volume/volume_renderer_fixture.h"

namespace surfcast::testing {
namespace {

using reference::LightPicture;

constexpr int kSide = 96;  // pixels

using VolumeNumericsGLTest = VolumeRendererTest;

picture::PictureRequest view(const geometry::Camera& camera) {
  picture::PictureRequest request;
  request.width = request.height = kSide;
  request.camera = camera;
  request.format = picture::PixelFormat::kLinearFloat;
  return request;
}

const geometry::Camera kAside{{1.3, 1.1, 3}, {0, 0, 0}, {0, 1, 0}, 36};
const glm::dvec3 kOrange{0.95, 0.6, 0.2};

// Means of a linear field, at the means of their places, are the field itself. So levels differ near the faces alone,
// beyond which samples are repeated, and every seam would show.
TEST_F(VolumeNumericsGLTest, BordersOfBricksAndLevelsDoNotShow) {
  const double step = 2.0 / 127;
  const ModelPointer model =
      model_of(reference::make_grid(glm::ivec3(128), glm::dvec3(-1), glm::dmat3(step),
                                    [](const glm::dvec3& p) { return 0.5 + 0.2 * p.x + 0.15 * p.y - 0.1 * p.z; }));
  picture::PictureRequest request = view({{0.75, 0.7, 1.1}, {-0.2, -0.2, -0.6}, {0, 1, 0}, 60});
  request.clip.inside.push_back({glm::dvec3(-0.8), glm::dvec3(0.8)});
  request.volumes.transfer.points = {{0.3, {0.2, 0.3, 0.9}, 0.01}, {0.5, kOrange, 0.03}, {0.7, {1, 1, 1}, 0.01}};
  const picture::Frame finest = frame_of(model, request);
  EXPECT_EQ(finest.stats.levels.size(), 1U);
  bool levels_met = false;
  for (const double spacing : {2.5, 3.0, 3.5, 5.0, 7.0}) {
    request.spacing = spacing;
    const picture::Frame mixed = frame_of(model, request);
    levels_met = levels_met || mixed.stats.levels.size() > 1;
    const double found = linear_psnr(light_of(mixed.image), light_of(finest.image));
    RecordProperty("dB_" + std::to_string(spacing),
                   std::to_string(found) + ", levels: " + std::to_string(mixed.stats.levels.size()));
    EXPECT_GE(found, 55) << spacing;
  }
  EXPECT_TRUE(levels_met);
}

/// A grid of 64 samples in 29 pixels, with its transfer function.
struct FromAfar {
  reference::VolumeScene scene = reference::make_volume_scene("torus", "far", glm::ivec3(64), 128);

  [[nodiscard]] picture::PictureRequest request(int side, double finer) const {
    const double angle = 2 * std::atan(0.5 * side / (finer * scene.frame.eta)) * 180 / std::numbers::pi;
    picture::PictureRequest request = view({scene.frame.eye, {0, 0, 0}, scene.frame.up, angle});
    request.width = request.height = side;
    request.volumes.transfer.spacing = scene.spacing;
    for (const reference::TransferPoint& p : scene.points) {
      request.volumes.transfer.points.push_back({p.value, p.srgb, p.opacity});
    }
    return request;
  }
};

TEST_F(VolumeNumericsGLTest, FromAfarTheCoarserLevelIsWithinItsLimit) {
  const FromAfar afar;
  picture::PictureRequest request = afar.request(128, 1);
  request.spacing = 2;
  const picture::Frame frame = frame_of(model_of(afar.scene.grid), request);
  ASSERT_EQ(frame.stats.levels.size(), 1U);
  EXPECT_GT(frame.stats.levels[0].level, 0);
  const double found = covered_psnr(light_of(frame.image), ideal_picture(afar.scene));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, 45.9);
}

TEST_F(VolumeNumericsGLTest, FromAfarSeveralSamplesAPixelAreWithinTheirLimit) {
  constexpr int kSamples = 3;
  const FromAfar afar;
  const int side = kSamples * (128 + 2 * reference::kFilterReach);
  const LightPicture lattice = light_of(frame_of(model_of(afar.scene.grid), afar.request(side, kSamples)).image);
  const double left = std::sqrt(kSamples * kSamples - 1.0) / kSamples;  // of a filter that the samples have had
  const double found = covered_psnr(reduced(lattice, kSamples, left), ideal_picture(afar.scene));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, 52);
}

TEST_F(VolumeNumericsGLTest, ExtinctionsOfAMillionAreSurfaces) {
  const reference::VolumeGrid grid = reference::sampled(reference::torus_field(), glm::ivec3(32));
  picture::PictureRequest request = view(kAside);
  request.volumes.transfer.points = {{0.4, kOrange, 0}, {0.4, kOrange, 1}};
  request.volumes.transfer.spacing = 1.6e-5;  // 16 of an opacity of 1
  const LightPicture drawn = light_of(frame_of(model_of(grid), request).image);
  const reference::TransferFunction transfer({{0.4, kOrange, 0}, {0.4, kOrange, 1}}, 1.6e-5);
  const auto frame = *geometry::make_camera_frame(kAside, kSide, kSide);
  const double found = covered_psnr(drawn, cast_cubic_rays(as_stored(grid), transfer, frame));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, 50);
  for (const glm::dvec4& pixel : drawn.pixels) {
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(std::isfinite(pixel[i]) && pixel[i] >= 0 && pixel[i] <= 1.0001);
  }
}

TEST_F(VolumeNumericsGLTest, AnOpaqueConstantFieldIsOneColourToTheBit) {
  const ModelPointer model = model_of(
      reference::make_grid({50, 40, 70}, {-1, -0.8, -0.7}, glm::dmat3(0.04), [](const glm::dvec3&) { return 0.5; }));
  picture::PictureRequest request = view(kAside);
  request.format = picture::PixelFormat::kSrgb8;
  request.volumes.transfer.points = {{0, kOrange, 1}, {1, kOrange, 1}};
  const picture::Image image = frame_of(model, request).image;
  const auto pixel = [&](int i) {
    uint32_t bytes = 0;
    std::memcpy(&bytes, image.pixels.data() + 4 * static_cast<size_t>(i), 4);
    return bytes;
  };
  const uint32_t middle = pixel(kSide * kSide / 2 + kSide / 2);
  EXPECT_EQ(middle >> 24, 255U);
  int opaque = 0;
  int different = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    if (pixel(i) >> 24 != 255) continue;
    if (++opaque; pixel(i) != middle) ++different;
  }
  EXPECT_GT(opaque, kSide * kSide / 8);
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace surfcast::testing
