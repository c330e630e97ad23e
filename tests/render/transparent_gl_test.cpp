// Surfels that are seen through: the renderer against analytic layers and against the double precision reference.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "reference/transparent_renderer.h"
#include "reference/transparent_scenes.h"
#include "render/decoded_cloud.h"
#include "render/gl_fixture.h"
#include "surfel/normalization_weights.h"
#include "surfel/opacity.h"

namespace surfcast::render {
namespace {

using reference::SrgbPicture;
using reference::TransparentScene;
using testing::decoded_cloud;

class TransparentGLTest : public testing::RendererFixture {
 protected:
  static SrgbPicture colors_of(const picture::Image& image) {
    SrgbPicture picture{image.width, image.height, {}};
    const auto* bytes = reinterpret_cast<const glm::u8vec4*>(image.pixels.data());
    for (int i = 0; i < image.width * image.height; ++i) picture.pixels.emplace_back(bytes[i]);
    return picture;
  }

  /// Draws a scene. Surfels have the opacity of the picture where they all have the same.
  picture::Image draw_scene(const TransparentScene& scene) {
    surfel::SurfelCloud cloud = scene.cloud;
    picture::PictureRequest request = scene.request;
    const auto [least, most] = std::minmax_element(scene.opacities.begin(), scene.opacities.end());
    if (*least < *most) {
      cloud.scalars = {{"alpha", std::vector<float>(scene.opacities.begin(), scene.opacities.end())}};
    } else {
      request.opacity = *most;
    }
    return draw(model_of(cloud), request).image;
  }
};

struct LayersGoal {
  const char* scene;
  double psnr;       ///< dB, at least, over the pixels of `part`
  const char* part;  ///< "inside", "edges" or "whole"
};
std::ostream& operator<<(std::ostream& out, const LayersGoal& goal) {
  return out << goal.scene << ' ' << goal.part << ' ' << goal.psnr << " dB";
}

class LayersGLTest : public TransparentGLTest, public ::testing::WithParamInterface<LayersGoal> {
 protected:
  /// The opacities of the surfels in the order of the file.
  std::vector<double> decoded_opacities(const TransparentScene& scene) const {
    std::vector<double> opacities;
    for (size_t b = 0; b < model_->blocks().size(); ++b) {
      if (model_->blocks()[b].level != 0) continue;
      const Result<model::DecodedBlock> block = model_->decode(b);
      if (!block) ADD_FAILURE() << block.error().message;
      for (size_t i = 0; i < block->size(); ++i) {
        opacities.push_back(block->scalars.empty() ? scene.opacities.front()
                                                   : surfel::opacity_at(block->scalars.front().values, i));
      }
    }
    return opacities;
  }
  static double psnr_of(const SrgbPicture& drawn, const SrgbPicture& ideal, const TransparentScene& scene) {
    std::vector<bool> mask = inside(scene);
    const std::string part = GetParam().part;
    if (part == "edges") mask.flip();
    if (part == "whole") mask.assign(mask.size(), true);
    return masked_psnr(drawn, ideal, mask);
  }
};

TEST_P(LayersGLTest, ComeNearTheAnalyticLayers) {
  const TransparentScene scene = reference::make_transparent_scene(GetParam().scene);
  const SrgbPicture ideal = reference::encode(reference::ideal_picture(scene));
  const SrgbPicture drawn = colors_of(draw_scene(scene));
  const SrgbPicture expected = reference::encode(
      reference::render_transparent(decoded_cloud(*model_), decoded_opacities(scene), scene.request).picture);
  const double reached = psnr_of(drawn, ideal, scene);
  std::printf("[ measured ] %.2f dB, %.2f dB from the reference\n", reached, psnr(drawn, expected));
  EXPECT_GE(reached, GetParam().psnr);
  EXPECT_GE(psnr(drawn, expected), 45);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, LayersGLTest,
    ::testing::Values(LayersGoal{"planes", 49, "inside"}, LayersGoal{"planes_noise_quarter", 46, "inside"},
                      LayersGoal{"planes_noise_half", 39, "inside"}, LayersGoal{"spheres", 38.5, "whole"},
                      LayersGoal{"spheres_noise_half", 34.5, "whole"}, LayersGoal{"planes_normal_noise", 39, "inside"},
                      LayersGoal{"spheres_normal_noise", 34.5, "whole"}, LayersGoal{"sheets_two_radii", 42, "inside"},
                      LayersGoal{"sheets_one_radius", 36, "inside"}, LayersGoal{"crossing_planes", 29.5, "edges"},
                      LayersGoal{"alpha_texture", 32, "whole"}, LayersGoal{"glass_shell", 40, "whole"}),
    [](const auto& goal) { return std::string(goal.param.scene); });

}  // namespace
}  // namespace surfcast::render
