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

using ModelPointer = std::shared_ptr<const model::ModelFile>;

/// One renderer for all cases of a program, so that shaders compile once. Models are written to a file and read back.
class RendererFixture : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    Result<std::unique_ptr<render::Renderer>> created = render::Renderer::create({});
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
    if (model_) renderer_->release_model(*model_);
  }

  /// The model of a cloud. It is released by the next call.
  const ModelPointer& model_of(const surfel::SurfelCloud& cloud) {
    if (model_) renderer_->release_model(*model_);
    const std::filesystem::path path = folder_ / "scene.surf";
    const Result<model::WriteReport> written = model::write_model(cloud, path, {});
    EXPECT_TRUE(written) << (written ? "" : written.error().message);
    Result<model::ModelFile> opened = model::ModelFile::open(path);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    model_ = std::make_shared<const model::ModelFile>(std::move(*opened));
    return model_;
  }

  static picture::Frame draw(const ModelPointer& model, const picture::PictureRequest& request) {
    const std::atomic<bool> cancelled{false};
    Result<picture::Frame> frame = renderer_->draw(model, request, cancelled);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return frame ? std::move(*frame) : picture::Frame{};
  }

  static glm::u8vec4 pixel(const picture::Image& image, int x, int y) {
    glm::u8vec4 p;
    std::memcpy(&p, image.pixels.data() + 4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + x), 4);
    return p;
  }
  static glm::vec4 light(const picture::Image& image, int x, int y) {
    glm::vec4 p;
    std::memcpy(&p, image.pixels.data() + 16 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + x), 16);
    return p;
  }

  static inline std::unique_ptr<render::Renderer> renderer_;
  static inline std::filesystem::path folder_;
  ModelPointer model_;
};

}  // namespace surfcast::testing
