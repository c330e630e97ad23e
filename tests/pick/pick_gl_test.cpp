// Compares picks with the pictures of the renderer.

#include <cstdlib>

#include "pick/pick_surfel.h"
#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::pick {
namespace {

using PickGLTest = testing::RendererFixture;

const glm::u8vec3 kSphere(220, 40, 30);
const glm::u8vec3 kFloor(20, 60, 230);

/// A sphere of class 6 above a floor of class 2.
surfel::SurfelCloud scene() {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(8000, 1, {0, 0, 0.2}, kSphere);
  const size_t sphere = cloud.size();
  testing::append(cloud, testing::square(120, 5, {0, 0, -1}, {0, 0, 1}, kFloor));
  std::vector<uint8_t> classes(cloud.size(), 2);
  std::fill(classes.begin(), classes.begin() + static_cast<std::ptrdiff_t>(sphere), uint8_t{6});
  cloud.scalars = {{"classification", classes}};
  return cloud;
}

bool near(const glm::u8vec4& pixel, const glm::u8vec3& color) {
  return std::abs(pixel.r - color.r) < 6 && std::abs(pixel.g - color.g) < 6 && std::abs(pixel.b - color.b) < 6;
}

class Agreement {
 public:
  void add(const glm::u8vec4& pixel, const std::optional<kinds::PickedSurfel>& picked) {
    // Where edges are blended, both results are correct.
    if (pixel.a == 0 && picked) ++wrong_;
    if (pixel.a != 255 || !(near(pixel, kSphere) || near(pixel, kFloor))) return;
    ++compared_;
    if (!picked || !near(pixel, *picked->color)) ++wrong_;
  }
  void expect_good(int least) const {
    EXPECT_GT(compared_, least);
    EXPECT_LE(wrong_, 1);
  }

 private:
  int compared_ = 0;
  int wrong_ = 0;
};

TEST_F(PickGLTest, PicksAgreeWithPicturesAlsoWhereSomethingIsHidden) {
  const testing::ModelPointer& model = model_of(scene());
  picture::PictureRequest request;
  request.width = 200;
  request.height = 150;
  for (const geometry::Camera& camera : {geometry::Camera{{4, -6, 5}, {0, 0, 0}, {0, 0, 1}, 40},
                                         geometry::Camera{{1.4, 0, 0}, {0, 0, 0}, {0, 0, 1}, 70}}) {
    for (const int option : {0, 1, 2}) {
      request.camera = camera;
      request.hidden_classes.reset();
      request.clip = {};
      if (option == 1) request.hidden_classes.set(6);
      if (option == 2) request.clip.outside.push_back({{-3, -3, 0}, {0.3, 3, 3}});
      const picture::Image image = draw(model, request).image;
      const geometry::CameraFrame frame = *geometry::make_camera_frame(camera, request.width, request.height);
      Agreement agreement;
      const std::atomic<bool> no{false};
      SourceBlocks blocks(size_t{1} << 20);
      for (int y = 3; y < request.height; y += 15) {
        for (int x = 3; x < request.width; x += 15) {
          const kinds::PickQuery query{frame, {x + 0.5, y + 0.5}, request.clip, request.hidden_classes};
          agreement.add(pixel(image, x, y), *pick_surfel(*model, query, blocks, no));
        }
      }
      agreement.expect_good(25);
    }
  }
}

}  // namespace
}  // namespace surfcast::pick
