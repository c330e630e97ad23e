// The accuracy of volumes drawn in double precision against ideal pictures, 128 x 128 pixels.

#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "reference/slab_renderer.h"
#include "reference/volume_scenes.h"

namespace surfcast::reference {
namespace {

constexpr int kSide = 128;  // pixels

struct Goal {
  const char* name;
  const char* field;
  const char* view;
  glm::ivec3 size;
  double psnr;  // dB, at least
  double closer = 1;
};
std::ostream& operator<<(std::ostream& out, const Goal& goal) {
  return out << goal.field << ' ' << goal.view << ' ' << goal.psnr << " dB";
}

class VolumeAccuracy : public testing::TestWithParam<Goal> {};

TEST_P(VolumeAccuracy, IsAtLeastTheLimit) {
  const Goal& goal = GetParam();
  VolumeScene scene = make_volume_scene(goal.field, goal.view, goal.size, kSide);
  scene.frame = volume_view(goal.view, kSide, goal.closer);
  const double found =
      covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture, ideal_picture(scene));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, goal.psnr);
}

INSTANTIATE_TEST_SUITE_P(Views, VolumeAccuracy,
                         testing::Values(Goal{"torus_mid", "torus", "mid", glm::ivec3(32), 51.5},
                                         Goal{"torus_closer", "torus", "mid", glm::ivec3(32), 51, 1.1},
                                         Goal{"torus_farther", "torus", "mid", glm::ivec3(32), 51, 0.9},
                                         Goal{"ball_mid", "ball", "mid", glm::ivec3(32), 37},
                                         Goal{"ball_closer", "ball", "mid", glm::ivec3(32), 36.5, 1.1},
                                         Goal{"ball_farther", "ball", "mid", glm::ivec3(32), 36.5, 0.9},
                                         Goal{"blobs_mid", "blobs", "mid", glm::ivec3(32), 55},
                                         Goal{"blobs_closer", "blobs", "mid", glm::ivec3(32), 54.5, 1.1},
                                         Goal{"blobs_farther", "blobs", "mid", glm::ivec3(32), 54.5, 0.9},
                                         Goal{"ml_mid", "ml", "mid", glm::ivec3(41), 37.5},
                                         Goal{"ml_closer", "ml", "mid", glm::ivec3(41), 36.5, 1.1},
                                         Goal{"ml_farther", "ml", "mid", glm::ivec3(41), 36.5, 0.9},
                                         Goal{"torus_low", "torus", "low", glm::ivec3(32), 50.5},
                                         Goal{"torus_wide", "torus", "wide", glm::ivec3(32), 49.5},
                                         Goal{"torus_near", "torus", "near", glm::ivec3(32), 50},
                                         Goal{"torus_inside", "torus", "inside", glm::ivec3(32), 50},
                                         Goal{"torus_anisotropic", "torus", "mid", glm::ivec3(32, 32, 16), 39.5}),
                         [](const auto& goal) { return std::string(goal.param.name); });

/// Drawn with 3 x 3 samples a pixel.
double from_afar(const VolumeGrid& grid, const VolumeScene& scene) {
  constexpr int kSamples = 3;
  SlabParameters parameters;
  parameters.filter = false;
  geometry::CameraFrame frame = scene.frame;
  frame.width = frame.height = kSamples * (kSide + 2 * kFilterReach);
  frame.eta *= kSamples;
  const LightPicture lattice = draw_slabs(grid, 0, scene.transfer, frame, parameters).picture;
  return covered_psnr(reduced(lattice, kSamples), ideal_picture(scene));
}

TEST(VolumeAccuracy, FromAfarNeedsSeveralSamplesAPixelOrACoarserLevel) {
  const VolumeScene scene = make_volume_scene("torus", "far", glm::ivec3(64), kSide);
  EXPECT_GE(from_afar(scene.grid, scene), 50);
  EXPECT_GE(from_afar(halved(scene.grid), scene), 46);
  EXPECT_GE(covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture, ideal_picture(scene)), 36);
}

TEST(VolumeAccuracy, OfShadedVolumesIsBetterThanRayCasting) {
  VolumeScene scene = make_volume_scene("torus", "mid", glm::ivec3(32), kSide);
  scene.shaded = true;
  const LightPicture ideal = ideal_picture(scene);
  SlabParameters shaded;
  shaded.shaded = true;
  const double slabs = covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame, shaded).picture, ideal);
  const LightPicture cast = ray_cast(scene.grid, scene.transfer, true, scene.frame, Reconstruction::kTrilinear);
  EXPECT_GE(slabs, 47.5);
  EXPECT_LT(covered_psnr(filtered(cast), ideal), slabs);
  RecordProperty("dB", std::to_string(slabs));
}

}  // namespace
}  // namespace surfcast::reference
