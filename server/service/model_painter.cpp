#include "service/model_painter.h"

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "service/rehearsal.h"

namespace surfcast {
namespace {

class ModelPainter : public Painter {
 public:
  ModelPainter(const ModelCatalogue& models, std::unique_ptr<Renderer> renderer)
      : models_(models), renderer_(std::move(renderer)) {
    if (const std::vector<std::string> names = models.names(); !names.empty()) next_model_ = names.front();
  }

  Result<Frame> draw(const std::string& name, const PictureRequest& request,
                     const Interruption& interruption) override {
    Result<std::shared_ptr<const ModelFile>> model = models_.open(name);
    if (!model) return fail(model.error());
    return renderer_->draw(current(name, std::move(*model)), request, interruption);
  }
  /// Draws the next of the tiny pictures of the model that was asked for last, at first of any.
  bool rehearse() override {
    if (!next_model_.empty()) begin_rehearsal(std::exchange(next_model_, {}));
    if (rehearsals_.empty()) return false;
    const std::atomic<bool> never{false};
    (void)renderer_->draw(rehearsed_, rehearsals_.front(), never);  // what fails here fails again when it is asked for
    rehearsals_.pop_front();
    if (rehearsals_.empty()) rehearsed_.reset();
    return !rehearsals_.empty();
  }
  [[nodiscard]] const DeviceInfo& device() const override { return renderer_->device(); }
  [[nodiscard]] int max_resolution() const override { return renderer_->max_resolution(); }

 private:
  /// Lets go of what is resident of a file that has been replaced.
  std::shared_ptr<const ModelFile> current(const std::string& name, std::shared_ptr<const ModelFile> model) {
    std::shared_ptr<const ModelFile>& drawn = drawn_[name];
    if (drawn && drawn != model) renderer_->forget(*drawn);
    if (!drawn) next_model_ = name;
    drawn = std::move(model);
    return drawn;
  }

  void begin_rehearsal(const std::string& name) {
    const Result<std::shared_ptr<const ModelFile>> model = models_.open(name);
    if (!model) return;
    rehearsed_ = current(name, *model);
    next_model_.clear();
    const std::vector<PictureRequest> pictures = rehearsal_of(rehearsed_->info());
    rehearsals_.assign(pictures.begin(), pictures.end());
  }

  const ModelCatalogue& models_;
  std::string next_model_;  ///< to be rehearsed; none: empty
  std::shared_ptr<const ModelFile> rehearsed_;
  std::deque<PictureRequest> rehearsals_;
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
