// Tests the constants of shaders/shared/transparency.h against analytic layers with the double precision reference
// renderer. docs/transparency.md has the figures.

#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "reference/transparent_renderer.h"
#include "reference/transparent_scenes.h"

namespace surfcast::reference {
namespace {

struct LayersGoal {
  const char* scene;
  double inside;  ///< dB, at least, where all rays of a pixel meet the same sheets
  double whole;   ///< dB, at least, of the whole picture
};
std::ostream& operator<<(std::ostream& out, const LayersGoal& goal) {
  return out << goal.inside << " dB inside, " << goal.whole << " dB";
}

class Transparency : public testing::TestWithParam<LayersGoal> {};

TEST_P(Transparency, ComesNearTheAnalyticLayers) {
  const TransparentScene scene = make_transparent_scene(GetParam().scene);
  const SrgbPicture ideal = encode(ideal_picture(scene));
  const SrgbPicture drawn = encode(render_transparent(scene.cloud, scene.opacities, scene.request).picture);
  EXPECT_GE(masked_psnr(drawn, ideal, inside(scene)), GetParam().inside);
  EXPECT_GE(psnr(drawn, ideal), GetParam().whole);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Transparency,
                         testing::Values(LayersGoal{"planes", 49, 45}, LayersGoal{"planes_noise_quarter", 46, 44},
                                         LayersGoal{"planes_noise_half", 39, 39}, LayersGoal{"spheres", 49, 38.5},
                                         LayersGoal{"spheres_noise_half", 39, 34.5},
                                         LayersGoal{"planes_normal_noise", 39, 39},
                                         LayersGoal{"spheres_normal_noise", 39, 38.5},
                                         LayersGoal{"sheets_two_radii", 42, 42},
                                         LayersGoal{"sheets_one_radius", 36, 36}, LayersGoal{"crossing_planes", 49, 40},
                                         LayersGoal{"alpha_texture", 32, 32}, LayersGoal{"glass_shell", 40, 40}),
                         [](const auto& goal) { return std::string(goal.param.scene); });

}  // namespace
}  // namespace surfcast::reference
