// Compares parts of the largest pictures, because the reference would need minutes for a whole one.

#include "numerics/numerics_fixture.h"
#include "support/clouds.h"

namespace surfcast::testing {
namespace {

TEST_F(NumericsGLTest, APictureOf8192PixelsSquare) {
  surfel::SurfelCloud cloud = square(400, 1, {0, 0, 0}, {0.4, 0.2, 1}, {0, 0, 0});
  paint_motley(cloud);
  const ModelPointer& model = model_of(cloud);
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0.1, -0.2, 1.6}, {0, 0, 0}, {0, 1, 0}, 25};
  request.width = request.height = 8192;
  request.format = picture::PixelFormat::kLinearFloat;
  const picture::Image image = draw(model, request).image;
  // Corners, region borders, and the centre.
  const reference::Window windows[] = {
      {0, 0, 64, 64}, {8128, 8128, 64, 64}, {2016, 2016, 64, 64}, {4064, 4064, 64, 64}, {6112, 3000, 64, 64}};
  for (const reference::Window& window : windows) {
    expect_within(difference("8192 x 8192 at " + std::to_string(window.x) + ' ' + std::to_string(window.y), image,
                             model, request, window),
                  kMagnified);
  }
}

}  // namespace
}  // namespace surfcast::testing
