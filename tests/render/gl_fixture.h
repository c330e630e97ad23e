#pragma once

#include <atomic>
#include <bit>
#include <cstring>
#include <filesystem>
#include <glm/vec4.hpp>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "model/write_model.h"
#include "render/renderer.h"

namespace surfcast::testing {

using ModelPointer = std::shared_ptr<const ModelFile>;

/// One renderer for all cases of a program: shaders compile once. Models go through a file, as they do in use.
class RendererFixture : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    Result<std::unique_ptr<Renderer>> created = Renderer::create({});
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("surfcast_" + std::string(::testing::UnitTest::GetInstance()->current_test_suite()->name()) + "_" +
               std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override {
    if (model_) renderer_->forget(*model_);
  }

  /// The model of a cloud, until the next call.
  const ModelPointer& model_of(const SurfelCloud& cloud) {
    if (model_) renderer_->forget(*model_);
    const std::filesystem::path path = folder_ / "scene.surf";
    const Result<WriteReport> written = write_model(cloud, path, {});
    EXPECT_TRUE(written) << (written ? "" : written.error().message);
    Result<ModelFile> opened = ModelFile::open(path);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    model_ = std::make_shared<const ModelFile>(std::move(*opened));
    return model_;
  }

  static Frame draw(const ModelPointer& model, const PictureRequest& request) {
    const std::atomic<bool> cancelled{false};
    Result<Frame> frame = renderer_->draw(model, request, cancelled);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return frame ? std::move(*frame) : Frame{};
  }

  static glm::u8vec4 pixel(const Image& image, int x, int y) {
    glm::u8vec4 p;
    std::memcpy(&p, image.pixels.data() + 4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + x), 4);
    return p;
  }
  static glm::vec4 light(const Image& image, int x, int y) {
    glm::vec4 p;
    std::memcpy(&p, image.pixels.data() + 16 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + x), 16);
    return p;
  }

  static inline std::unique_ptr<Renderer> renderer_;
  static inline std::filesystem::path folder_;
  ModelPointer model_;
};

}  // namespace surfcast::testing
