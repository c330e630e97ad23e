#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "service/first_look.h"
#include "service/renderer_factories.h"
#include "service/shader_warm_up.h"

namespace surfcast::service {
namespace {

class CatalogueRenderer : public FrameRenderer {
 public:
  CatalogueRenderer(const ModelCatalogue& models, std::unique_ptr<ModelRenderer> renderer, ShaderWarmUp warm_up,
                    ModelPlace place)
      : models_(models), shader_warm_up_(warm_up), renderer_(std::move(renderer)) {
    const std::vector<std::string> names = models.names();
    const auto first = std::ranges::find_if(names, [&](const std::string& name) { return lies_in(name, place); });
    if (first != names.end()) next_model_ = *first;
  }

  Result<picture::Frame> draw(const std::string& name, const picture::PictureRequest& request,
                              const Preemption& preemption) override {
    Result<picture::Frame> frame = draw_once(name, request, preemption);
    if (frame || frame.error().kind != ErrorKind::kReplaced) return frame;
    return draw_once(name, request, preemption);  // the catalogue opens the model anew
  }
  /// Draws the next warm-up picture: of the model that was most recently drawn for the first time, or before that, of
  /// the first model in the catalogue.
  bool warm_up(const Preemption& preemption) override {
    release_removed();
    if (shader_warm_up_ == ShaderWarmUp::kOff) return false;
    if (!next_model_.empty()) begin_warm_up(std::exchange(next_model_, {}));
    if (warm_ups_.empty()) return false;
    // A failure is reported when the model is requested.
    (void)renderer_->draw(warming_model_, warm_ups_.front(), preemption);
    if (preemption.cancelled()) return true;
    warm_ups_.pop_front();
    if (warm_ups_.empty()) warming_model_.reset();
    return !warm_ups_.empty();
  }
  [[nodiscard]] const picture::DeviceInfo& device() const override { return renderer_->device(); }
  [[nodiscard]] int max_resolution() const override { return renderer_->max_resolution(); }

 private:
  [[nodiscard]] bool lies_in(const std::string& name, ModelPlace place) const {
    return place == ModelPlace::kAnywhere || models_.remote(name) == (place == ModelPlace::kStore);
  }

  Result<picture::Frame> draw_once(const std::string& name, const picture::PictureRequest& request,
                                   const Preemption& preemption) {
    Result<ModelCatalogue::Edition> edition = models_.open_edition(name, request.edition);
    if (!edition) return fail(edition);
    keep(name, edition->model);
    const picture::PictureRequest looked = with_first_look(request, edition->model->info());
    Result<picture::Frame> frame = renderer_->draw(edition->model, looked, preemption);
    if (frame) frame->preview = edition->preview;
    return frame;
  }

  /// Notes a model as drawn, and releases the resident blocks of those that it replaces. Views may still show the
  /// edition before the newest one of a scan's model.
  void keep(const std::string& name, const std::shared_ptr<const model::ModelFile>& model) {
    if (!model->members().empty()) note_join(name);
    std::vector<std::shared_ptr<const model::ModelFile>>& drawn = drawn_[name];
    if (std::ranges::find(drawn, model) != drawn.end()) return;
    if (drawn.empty()) next_model_ = name;
    drawn.push_back(model);
    const size_t most = models_.edition(name) > 0 ? 2 : 1;
    while (drawn.size() > most) {
      renderer_->release_model(*drawn.front());
      drawn.erase(drawn.begin());
    }
  }

  /// Anyone can join models in many ways: only the joins that were drawn last stay.
  void note_join(const std::string& name) {
    std::erase(joins_, name);
    joins_.push_back(name);
    if (joins_.size() <= ModelCatalogue::kKeptJoins) return;
    for (const auto& model : drawn_[joins_.front()]) renderer_->release_model(*model);
    drawn_.erase(joins_.front());
    joins_.erase(joins_.begin());
  }

  /// Releases what is resident of models whose files have gone.
  void release_removed() {
    models_.close_removed();
    std::erase_if(drawn_, [this](const auto& entry) {
      if (models_.has(entry.first)) return false;
      for (const auto& model : entry.second) renderer_->release_model(*model);
      std::erase(joins_, entry.first);
      return true;
    });
  }

  void begin_warm_up(const std::string& name) {
    const Result<std::shared_ptr<const model::ModelFile>> model = models_.open(name);
    if (!model) return;
    warming_model_ = *model;
    keep(name, warming_model_);
    next_model_.clear();
    const std::vector<picture::PictureRequest> pictures = shader_warm_up_requests(*warming_model_);
    warm_ups_.assign(pictures.begin(), pictures.end());
  }

  const ModelCatalogue& models_;
  ShaderWarmUp shader_warm_up_;
  std::string next_model_;  ///< next model to warm up; empty: none
  std::shared_ptr<const model::ModelFile> warming_model_;
  std::deque<picture::PictureRequest> warm_ups_;
  std::map<std::string, std::vector<std::shared_ptr<const model::ModelFile>>> drawn_;  ///< by name, oldest first
  std::vector<std::string> joins_;                                                     ///< of them, least recent first
  std::unique_ptr<ModelRenderer> renderer_;
};

}  // namespace

FrameRendererFactory catalogue_renderers(const ModelCatalogue& models, ModelRendererFactory make_renderer,
                                         ShaderWarmUp warm_up, ModelPlace place) {
  return
      [&models, make_renderer = std::move(make_renderer), warm_up, place]() -> Result<std::unique_ptr<FrameRenderer>> {
        Result<std::unique_ptr<ModelRenderer>> renderer = make_renderer();
        if (!renderer) return fail(renderer);
        return std::make_unique<CatalogueRenderer>(models, std::move(*renderer), warm_up, place);
      };
}

}  // namespace surfcast::service
