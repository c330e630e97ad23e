#include <filesystem>
#include <glm/vec4.hpp>

#include <gtest/gtest.h>

#include "model/model_writer.h"
#include "render/renderer.h"
#include "support/clouds.h"

namespace surfcast {
namespace {

namespace fs = std::filesystem;

/// One renderer for all cases: shaders compile once.
class RendererGLTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    Result<std::unique_ptr<Renderer>> created = Renderer::create({});
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
    folder_ = fs::path(::testing::TempDir()) / "surfcast_renderer_gl_test";
    fs::create_directories(folder_);
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    fs::remove_all(folder_);
  }

  static ModelFile model_of(const SurfelCloud& cloud, const char* name) {
    const fs::path path = folder_ / name;
    const Result<WriteReport> written = write_model(cloud, path, {});
    EXPECT_TRUE(written) << (written ? "" : written.error().message);
    Result<ModelFile> model = ModelFile::open(path);
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return std::move(*model);
  }

  static Frame draw(const ModelFile& model, const PictureRequest& request) {
    const std::atomic<bool> cancelled{false};
    Result<Frame> frame = renderer_->draw(model, request, cancelled);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return frame ? std::move(*frame) : Frame{};
  }

  static glm::u8vec4 pixel(const Image& image, int x, int y) {
    const auto* p = reinterpret_cast<const uint8_t*>(image.pixels.data()) + 4 * (y * image.width + x);
    return {p[0], p[1], p[2], p[3]};
  }

  static inline std::unique_ptr<Renderer> renderer_;
  static inline fs::path folder_;
};

PictureRequest front_view(int width, int height) {
  PictureRequest request;
  request.camera = Camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30};
  request.width = width;
  request.height = height;
  return request;
}

TEST_F(RendererGLTest, SphereOfOneColorIsThatColorInEveryCoveredPixel) {
  const ModelFile model = model_of(testing::fibonacci_sphere(100000, 1, {0, 0, 0}, {200, 90, 20}), "sphere.surf");
  for (const Normalization normalization : {Normalization::kPixel, Normalization::kSurfel}) {
    PictureRequest request = front_view(512, 512);
    request.normalization = normalization;
    const Frame frame = draw(model, request);
    int covered = 0;
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        const glm::u8vec4 p = pixel(frame.image, x, y);
        if (p.a != 255) continue;
        ++covered;
        ASSERT_NEAR(p.r, 200, 1) << x << ' ' << y;
        ASSERT_NEAR(p.g, 90, 1) << x << ' ' << y;
        ASSERT_NEAR(p.b, 20, 1) << x << ' ' << y;
      }
    }
    // The sphere subtends asin(1/5): a disc of radius eta tan(asin(1/5)) = 195 pixels.
    EXPECT_NEAR(covered, 3.14159 * 195 * 195, 3000);
  }
}

}  // namespace
}  // namespace surfcast
