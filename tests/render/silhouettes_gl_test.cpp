// Silhouettes sampled again: crowded tiles, whatever lies in them, are drawn to the end of every sample.

#include <algorithm>
#include <string>

#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

class SilhouettesGLTest : public testing::RendererFixture {
 protected:
  static picture::PictureRequest view(const glm::dvec3& eye, const glm::dvec3& target) {
    picture::PictureRequest request;
    request.camera = geometry::Camera{eye, target, {0, 1, 0}, 30};
    request.width = 96;
    request.height = 64;
    return request;
  }

  /// The largest of a pixel's linear light.
  static float brightness(const picture::Image& image, int x, int y) {
    const glm::vec4 p = light(image, x, y);
    return std::max({p.r, p.g, p.b});
  }

  /// The least brightness of the pixel and its neighbours.
  static float darkest_around(const picture::Image& image, int x, int y) {
    float least = brightness(image, x, y);
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width - 1); ++i) {
        least = std::min(least, brightness(image, i, j));
      }
    }
    return least;
  }

  /// Pixels of a picture with silhouettes sampled again that are half as bright as anything near them in the
  /// per-surfel picture, which has no samples. Prints what it finds.
  static int specks(const std::string& what, const testing::ModelPointer& model, picture::PictureRequest request) {
    request.format = picture::PixelFormat::kLinearFloat;
    request.silhouettes = true;
    const picture::Image sampled = draw(model, request).image;
    request.normalization = picture::Normalization::kSurfel;
    const picture::Image whole = draw(model, request).image;
    int count = 0;
    for (int y = 0; y < sampled.height; ++y) {
      for (int x = 0; x < sampled.width; ++x) {
        const bool speck = brightness(sampled, x, y) < 0.5F * darkest_around(whole, x, y);
        count += speck ? 1 : 0;
      }
    }
    std::cout << what << ": " << count << " specks\n";
    return count;
  }
};

TEST_F(SilhouettesGLTest, ALargeSplatBeforeACrowdedSurfaceLeavesNoSpecks) {
  // Ten surfels a pixel side by side, and before them one surfel of half the picture's height.
  surfel::SurfelCloud cloud = testing::square(700, 4, {0, 0, 0}, {0, 0, 1}, {200, 200, 200});
  testing::append(cloud, testing::single_surfel({0.05, 0.02, 3}, {0.1, 0.2, 1}, 0.2F, {240, 230, 220}));
  const testing::ModelPointer& model = model_of(cloud);
  EXPECT_EQ(specks("a surfel before a surface", model, view({0, 0, 5}, {0, 0, 0})), 0);
}

}  // namespace
}  // namespace surfcast::render
