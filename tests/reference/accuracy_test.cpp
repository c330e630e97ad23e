// Tests the constants of shaders/shared/kernel.h against ideal pictures with the double precision reference renderer.
// docs/kernel.md describes how they were chosen.

#include <algorithm>
#include <ostream>

#include <gtest/gtest.h>

#include "reference/reference_renderer.h"
#include "reference/scenes.h"

namespace surfcast::reference {
namespace {

struct Goal {
  const char* scene;
  double psnr;          // dB, at least
  double coverage = 1;  // of pixels inside the surface, at least
};
std::ostream& operator<<(std::ostream& out, const Goal& goal) {
  return out << goal.psnr << " dB";
}

class Accuracy : public testing::TestWithParam<Goal> {};

TEST_P(Accuracy, IsAtLeastTheLimitAndLeavesNoHole) {
  Scene scene = make_scene(GetParam().scene);
  scene.request.silhouettes = true;  // as in a picture at rest
  const ReferencePicture result = render(scene.cloud, scene.request);
  EXPECT_GE(psnr(encode(result.picture), encode(ideal_picture(scene))), GetParam().psnr);
  const std::vector<double> inside = ideal_coverage(scene);
  double least = 1;
  for (size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] > 0.9999) least = std::min(least, result.coverage[i]);
  }
  EXPECT_GE(least, GetParam().coverage);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Accuracy,
                         testing::Values(Goal{"checker_oblique", 33.0}, Goal{"checker_grazing", 34.0},
                                         Goal{"checker_close", 17.0}, Goal{"checker_far", 44.0},
                                         Goal{"checker_sphere", 27.5, 0.5}, Goal{"smooth_oblique", 36.0},
                                         Goal{"noise_oblique", 34.5}, Goal{"edge_oblique", 33.0},
                                         Goal{"lit_sphere", 43.5, 0.5}),
                         [](const auto& goal) { return std::string(goal.param.scene); });

}  // namespace
}  // namespace surfcast::reference
