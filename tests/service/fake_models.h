#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "access/authorization.h"
#include "service/frame_renderer.h"
#include "service/model_source.h"

namespace surfcast::service {

/// A model as somebody asks for it who may know of all.
inline access::AuthorizedModel authorized(const std::string& name) {
  return access::Rights::unlimited().authorize(name);
}

/// Two models: "cube", z-up, and "teapot", y-up.
class FakeModels : public ModelSource {
 public:
  [[nodiscard]] std::vector<std::string> names() const override { return {"cube", "teapot"}; }
  [[nodiscard]] std::vector<ScanStatus> scans() const override { return scan_list; }
  [[nodiscard]] bool awaited(const std::string& name) const override { return !name.empty() && awaited_model == name; }
  [[nodiscard]] uint64_t edition(const std::string& name) const override {
    return name == "cube" ? cube_edition.load() : 0;
  }
  [[nodiscard]] bool remote(const std::string& name) const override { return name == remote_model; }
  [[nodiscard]] Result<ModelDescription> describe(const std::string& name) const override {
    if (name != "cube" && name != "teapot")
      return fail(ErrorKind::kNotFound, access::shown_name(name) + ": there is no such model");
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
    if (name == "cube")
      description.georeference = {{"UTM zone 32N", "EPSG:25832", "PROJCRS[1]"}, {"WGS 84", "", "GEOGCRS[2]"}};
    description.blocks = 7;
    return description;
  }
  [[nodiscard]] Result<std::shared_ptr<const model::ModelFile>> open(const std::string& name) const override {
    if (name == "cube" && cube_file) return cube_file;
    return fail(ErrorKind::kNotFound, access::shown_name(name) + ": there is no file of this model");
  }

  std::vector<ScanStatus> scan_list;  ///< set it before the service starts
  std::string awaited_model;          ///< likewise, or before models_changed()
  std::string remote_model;           ///< set it before the service starts
  std::atomic<uint64_t> cube_edition = 0;
  std::shared_ptr<const model::ModelFile> cube_file;  ///< null: there is none
};

/// The behaviour of a fake renderer and its counters, shared with the test.
struct FakeRendererControl {
  std::atomic<int> drawn = 0;          ///< pictures started
  std::atomic<int> cancelled = 0;      ///< pictures cancelled while they were drawn
  std::atomic<int> nested_frames = 0;  ///< times that other pictures were drawn during a slow picture
  static constexpr int kWarmUps = 3;
  std::atomic<int> warmed_up = 0;                 ///< number of warm-up steps begun
  std::atomic<bool> slow_to_warm_up = false;      ///< a step continues until it is cancelled
  std::atomic<int> frame_ms = 0;                  ///< least duration of a picture
  std::atomic<bool> slow = false;                 ///< a picture continues until it is cancelled or `slow` becomes false
  std::atomic<bool> slow_motion = true;           ///< motion pictures are slow too
  std::atomic<uint64_t> preview_editions = 0;     ///< editions up to this one are previews
  std::atomic<bool> loading = false;              ///< blocks of the newest edition are still missing
  std::atomic<uint64_t> loading_edition = 0;      ///< that edition
  std::vector<uint64_t> editions;                 ///< asked for; read it only while nothing is drawn
  std::vector<picture::PictureRequest> requests;  ///< likewise
  std::string slow_model;                         ///< if not empty, pictures of other models are not slow
  std::vector<std::string>
      order;  ///< models in the order in which they were drawn; read it only while nothing is drawn
};

/// Fills pictures with the background colour; those of the model "noise" with incompressible content.
class FakeRenderer : public FrameRenderer {
 public:
  explicit FakeRenderer(std::shared_ptr<FakeRendererControl> control) : control_(std::move(control)) {}

  Result<picture::Frame> draw(const std::string& model, const picture::PictureRequest& request,
                              const Preemption& preemption) override {
    control_->order.push_back(model);
    control_->requests.push_back(request);
    ++control_->drawn;
    const bool slow_too = (request.viewer == 0 || control_->slow_motion) &&
                          (control_->slow_model.empty() || control_->slow_model == model);
    for (int ms = 0; ms < control_->frame_ms; ++ms) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (preemption.yield_to_urgent()) ++control_->nested_frames;
    }
    while (control_->slow && slow_too && !preemption.cancelled()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (preemption.yield_to_urgent()) ++control_->nested_frames;
    }
    if (preemption.cancelled()) {
      ++control_->cancelled;
      return fail(ErrorKind::kCancelled, "cancelled");
    }
    const bool known = model == "cube" || model == "teapot" || model == "noise";
    if (!known) return fail(ErrorKind::kNotFound, access::shown_name(model) + ": there is no such model");
    control_->editions.push_back(request.edition);
    picture::Frame frame;
    frame.preview = request.edition > 0 && request.edition <= control_->preview_editions;
    if (control_->loading && request.edition == control_->loading_edition && request.max_missing_blocks == 0) {
      frame.stats.blocks_missing = 3;
      return frame;  // without pixels
    }
    frame.image = plain_image(request);
    if (model == "noise") add_noise(frame.image);
    if (request.camera) frame.camera = *request.camera;
    if (request.depth_texels > 0 && model != "teapot") {  // which is transparent, as it were
      frame.depth = picture::empty_depth_map(request.width, request.height, request.depth_texels);
      frame.depth.inverse.front() = 0.5F;
      frame.depth.inverse.back() = 0.25F;
    }
    frame.converged = true;
    frame.nothing_pending = true;
    frame.cut = 7;
    frame.stats.surfels_drawn = 99;
    frame.stats.blocks_drawn = 5;
    frame.stats.gl_renderer = "fake";
    frame.stats.stages = {{"draw", 1.5}};
    return frame;
  }
  bool warm_up(const Preemption& preemption) override {
    ++control_->warmed_up;
    while (control_->slow_to_warm_up && !preemption.cancelled()) (void)preemption.yield_to_urgent();
    return control_->warmed_up < FakeRendererControl::kWarmUps;
  }
  [[nodiscard]] const picture::DeviceInfo& device() const override { return device_; }
  [[nodiscard]] int max_resolution() const override { return 8192; }

 private:
  static picture::Image plain_image(const picture::PictureRequest& request) {
    picture::Image image{request.width, request.height, request.format, {}};
    const size_t pixels = static_cast<size_t>(request.width) * static_cast<size_t>(request.height);
    if (request.format == picture::PixelFormat::kLinearFloat) {
      image.pixels.resize(pixels * 4 * sizeof(float));
      return image;
    }
    for (size_t i = 0; i < pixels; ++i) {
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<std::byte>(request.background[c]));
      image.pixels.push_back(std::byte{0});
    }
    return image;
  }

  static void add_noise(picture::Image& image) {
    std::mt19937 random(1);
    for (std::byte& byte : image.pixels) byte = static_cast<std::byte>(random());
  }

  std::shared_ptr<FakeRendererControl> control_;
  picture::DeviceInfo device_{"nobody", "fake", "1", false, {.gpu = 3000, .host = 2000}};
};

inline FrameRendererFactory fake_renderers(std::shared_ptr<FakeRendererControl> control) {
  return [control]() -> Result<std::unique_ptr<FrameRenderer>> { return std::make_unique<FakeRenderer>(control); };
}

}  // namespace surfcast::service
