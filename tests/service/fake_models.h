#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "service/model_source.h"
#include "service/painter.h"

namespace surfcast {

/// Two models: "cube", z-up, and "teapot", y-up.
class FakeModels : public ModelSource {
 public:
  [[nodiscard]] std::vector<std::string> names() const override { return {"cube", "teapot"}; }
  [[nodiscard]] Result<ModelDescription> describe(const std::string& name) const override {
    if (name != "cube" && name != "teapot") return fail(ErrorKind::kNotFound, name + ": there is no such model");
    ModelDescription description;
    description.info.surfels = 1234;
    description.info.bounds.include(glm::dvec3{-1, -2, -3});
    description.info.bounds.include(glm::dvec3{4, 5, 6});
    description.info.z_up = name == "cube";
    description.info.color_bits = 8;
    description.info.scalar_names = {"intensity"};
    description.info.source_names = {name + ".las"};
    description.info.ranges = {{"intensity", 1, 9, 2, 8}};
    description.info.classes = {{2, 1200}, {6, 34}};
    description.spacing = 0.25;
    description.levels = 3;
    description.blocks = 7;
    return description;
  }
  [[nodiscard]] Result<std::shared_ptr<const ModelFile>> open(const std::string& name) const override {
    return fail(ErrorKind::kNotFound, name + ": there is no file of this model");
  }
};

/// What a fake painter is told to do, shared with the test that watches it.
struct FakeStudio {
  std::atomic<int> drawn = 0;       ///< pictures begun
  std::atomic<int> cancelled = 0;   ///< pictures given up half-way
  std::atomic<int> interludes = 0;  ///< others were drawn in the middle of a slow picture
  static constexpr int kRehearsals = 3;
  std::atomic<int> rehearsed = 0;       ///< times
  std::atomic<int> frame_ms = 0;        ///< that a picture takes at least
  std::atomic<bool> slow = false;       ///< every picture goes on until it is cancelled or `slow` is taken back
  std::atomic<bool> slow_quick = true;  ///< pictures for motion are as slow as others
  std::vector<std::string> order;       ///< models in the order they were drawn; read it when nothing is being drawn
};

/// Fills pictures with the background's colour, or for the model "noise" with what no format makes smaller.
class FakePainter : public Painter {
 public:
  explicit FakePainter(std::shared_ptr<FakeStudio> studio) : studio_(std::move(studio)) {}

  Result<Frame> draw(const std::string& model, const PictureRequest& request,
                     const Interruption& interruption) override {
    studio_->order.push_back(model);
    ++studio_->drawn;
    const bool slow_too = request.viewer == 0 || studio_->slow_quick;
    for (int ms = 0; ms < studio_->frame_ms; ++ms) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (interruption.step_aside()) ++studio_->interludes;
    }
    while (studio_->slow && slow_too && !interruption.cancelled()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (interruption.step_aside()) ++studio_->interludes;
    }
    if (interruption.cancelled()) {
      ++studio_->cancelled;
      return fail(ErrorKind::kCancelled, "cancelled");
    }
    const bool known = model == "cube" || model == "teapot" || model == "noise";
    if (!known) return fail(ErrorKind::kNotFound, model + ": there is no such model");
    Frame frame;
    frame.image = plain_image(request);
    if (model == "noise") add_noise(frame.image);
    if (request.camera) frame.camera = *request.camera;
    frame.converged = true;
    frame.settled = true;
    frame.cut = 7;
    frame.stats.surfels_drawn = 99;
    frame.stats.blocks_drawn = 5;
    frame.stats.gl_renderer = "fake";
    frame.stats.stages = {{"draw", 1.5}};
    return frame;
  }
  bool rehearse() override { return ++studio_->rehearsed < FakeStudio::kRehearsals; }
  [[nodiscard]] const DeviceInfo& device() const override { return device_; }
  [[nodiscard]] int max_resolution() const override { return 8192; }

 private:
  static Image plain_image(const PictureRequest& request) {
    Image image{request.width, request.height, request.format, {}};
    const size_t pixels = static_cast<size_t>(request.width) * static_cast<size_t>(request.height);
    if (request.format == PixelFormat::kLinearFloat) {
      image.pixels.resize(pixels * 4 * sizeof(float));
      return image;
    }
    for (size_t i = 0; i < pixels; ++i) {
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<std::byte>(request.background[c]));
      image.pixels.push_back(std::byte{0});
    }
    return image;
  }

  static void add_noise(Image& image) {
    std::mt19937 random(1);
    for (std::byte& byte : image.pixels) byte = static_cast<std::byte>(random());
  }

  std::shared_ptr<FakeStudio> studio_;
  DeviceInfo device_{"nobody", "fake", "1", false};
};

inline PainterFactory fake_painters(std::shared_ptr<FakeStudio> studio) {
  return [studio]() -> Result<std::unique_ptr<Painter>> { return std::make_unique<FakePainter>(studio); };
}

}  // namespace surfcast
