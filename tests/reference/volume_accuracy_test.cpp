// The accuracy of volumes drawn in double precision against ideal pictures, 128 x 128 pixels.

#include <string>

#include <gtest/gtest.h>

#include "reference/slab_renderer.h"
#include "reference/volume_goals.h"
#include "reference/volume_scenes.h"

namespace surfcast::reference {
namespace {

constexpr int kSide = kGoalSide;

class VolumeAccuracy : public testing::TestWithParam<VolumeGoal> {};

TEST_P(VolumeAccuracy, IsAtLeastTheLimit) {
  const VolumeGoal& goal = GetParam();
  VolumeScene scene = make_volume_scene(goal.field, goal.view, goal.size, kSide);
  scene.frame = volume_view(goal.view, kSide, goal.closer);
  const double found =
      covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture, ideal_picture(scene));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, goal.kernels);
}

INSTANTIATE_TEST_SUITE_P(Views, VolumeAccuracy, testing::ValuesIn(kVolumeGoals),
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

TEST(VolumeAccuracy, FromAfarGainsBySeveralSamplesAPixelOrACoarserLevel) {
  const VolumeScene scene = make_volume_scene("torus", "far", glm::ivec3(64), kSide);
  EXPECT_GE(from_afar(scene.grid, scene), 50);
  EXPECT_GE(from_afar(halved(scene.grid), scene), 46);
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
