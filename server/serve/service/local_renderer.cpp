#include <utility>

#include "gl/device_status.h"
#include "service/renderer_factories.h"

namespace surfcast::service {
namespace {

class LocalRenderer : public ModelRenderer {
 public:
  LocalRenderer(std::unique_ptr<render::Renderer> renderer, std::function<void()> on_reset)
      : renderer_(std::move(renderer)), on_reset_(std::move(on_reset)) {}

  Result<picture::Frame> draw(const std::shared_ptr<const model::ModelFile>& model,
                              const picture::PictureRequest& request, const Preemption& preemption) override {
    Result<picture::Frame> frame = renderer_->draw(model, request, preemption);
    if (was_reset()) return fail(ErrorKind::kUnavailable, "the GPU was reset, and the server ends");
    return frame;
  }
  void release_model(const model::ModelFile& model) override { renderer_->release_model(model); }
  [[nodiscard]] const picture::DeviceInfo& device() const override { return renderer_->device(); }
  [[nodiscard]] int max_resolution() const override { return renderer_->max_resolution(); }

 private:
  /// What was drawn since is worth nothing then, and nothing can be drawn any more.
  bool was_reset() {
    if (!reset_ && gl::context_was_reset()) {
      reset_ = true;
      on_reset_();
    }
    return reset_;
  }

  std::unique_ptr<render::Renderer> renderer_;
  std::function<void()> on_reset_;
  bool reset_ = false;
};

}  // namespace

ModelRendererFactory local_renderers(const render::RendererConfig& config, std::function<void()> on_reset) {
  return [config, on_reset = std::move(on_reset)]() -> Result<std::unique_ptr<ModelRenderer>> {
    Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create(config);
    if (!renderer) return fail(renderer);
    return std::make_unique<LocalRenderer>(std::move(*renderer), on_reset);
  };
}

}  // namespace surfcast::service
