#include "service/model_painter.h"

#include <map>
#include <memory>
#include <string>
#include <utility>

namespace surfcast {
namespace {

class ModelPainter : public Painter {
 public:
  ModelPainter(const ModelCatalogue& models, std::unique_ptr<Renderer> renderer)
      : models_(models), renderer_(std::move(renderer)) {}

  Result<Frame> draw(const std::string& name, const PictureRequest& request,
                     const Interruption& interruption) override {
    Result<std::shared_ptr<const ModelFile>> model = models_.open(name);
    if (!model) return fail(model.error());
    return renderer_->draw(current(name, std::move(*model)), request, interruption);
  }
  [[nodiscard]] const DeviceInfo& device() const override { return renderer_->device(); }
  [[nodiscard]] int max_resolution() const override { return renderer_->max_resolution(); }

 private:
  /// Lets go of what is resident of a file that has been replaced.
  std::shared_ptr<const ModelFile> current(const std::string& name, std::shared_ptr<const ModelFile> model) {
    std::shared_ptr<const ModelFile>& drawn = drawn_[name];
    if (drawn && drawn != model) renderer_->forget(*drawn);
    drawn = std::move(model);
    return drawn;
  }

  const ModelCatalogue& models_;
  std::map<std::string, std::shared_ptr<const ModelFile>> drawn_;  ///< by name
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace

PainterFactory model_painters(const ModelCatalogue& models, const RendererConfig& config) {
  return [&models, config]() -> Result<std::unique_ptr<Painter>> {
    Result<std::unique_ptr<Renderer>> renderer = Renderer::create(config);
    if (!renderer) return fail(renderer.error());
    return std::make_unique<ModelPainter>(models, std::move(*renderer));
  };
}

}  // namespace surfcast
