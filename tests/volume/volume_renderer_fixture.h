#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "render/renderer.h"
#include "volume/grid_scene.h"

namespace surfcast::testing {

using ModelPointer = std::shared_ptr<const model::ModelFile>;

inline picture::Frame frame_of(render::Renderer& renderer, const ModelPointer& model,
                               const picture::PictureRequest& request) {
  const std::atomic<bool> never{false};
  Result<picture::Frame> frame = renderer.draw(model, request, never);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return frame ? std::move(*frame) : picture::Frame{};
}

/// One renderer for the tests of a suite, and a folder for their models. One context at a time: the previous suite's is
/// gone before this one's is made.
class VolumeRendererTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    render::RendererConfig config;
    config.kinds = kinds_with_plain_bricks();
    Result<std::unique_ptr<render::Renderer>> created = render::Renderer::create(config);
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
    folder_ = std::filesystem::path(::testing::TempDir()) / ("surfcast_volumes_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    std::filesystem::remove_all(folder_);
  }

  static ModelPointer model_of(const reference::VolumeGrid& grid) {
    Result<model::ModelFile> model = model::ModelFile::open(write_volume(folder_ / "volume.surf", grid));
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model ? std::make_shared<const model::ModelFile>(std::move(*model)) : nullptr;
  }
  static picture::Frame frame_of(const ModelPointer& model, const picture::PictureRequest& request) {
    return testing::frame_of(*renderer_, model, request);
  }

  static inline std::unique_ptr<render::Renderer> renderer_;
  static inline std::filesystem::path folder_;
};

}  // namespace surfcast::testing
