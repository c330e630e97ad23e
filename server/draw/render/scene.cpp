#include "render/scene.h"

#include <algorithm>
#include <utility>

#include "model/fit_model.h"

namespace surfcast::render {

Result<std::unique_ptr<Scene>> Scene::create(const std::shared_ptr<const model::ModelFile>& model,
                                             kinds::KindTable kinds) {
  Result<std::vector<uint32_t>> numbers = kinds::find_kinds(*model, kinds);
  if (!numbers) return fail(numbers);
  const auto drawn_as = [&](kinds::DrawnAs form) {
    return std::ranges::any_of(*numbers, [&](uint32_t kind) { return kinds[kind]->drawn_as() == form; });
  };
  Kinds found;
  found.surfaces = drawn_as(kinds::DrawnAs::kSurface);
  found.gaussians = drawn_as(kinds::DrawnAs::kGaussians);
  found.glyphs = drawn_as(kinds::DrawnAs::kGlyphs);
  const bool volumes = drawn_as(kinds::DrawnAs::kVolume);
  found.mixed = int{found.surfaces} + int{found.gaussians} + int{found.glyphs} + int{volumes} > 1;
  auto blocks = std::make_shared<const kinds::FileBlocks>(model, kinds, std::move(*numbers));
  return std::unique_ptr<Scene>(new Scene(model, std::move(blocks), found));
}

Scene::Scene(std::shared_ptr<const model::ModelFile> model, std::shared_ptr<const kinds::FileBlocks> blocks,
             const Kinds& kinds)
    : model_(std::move(model)),
      blocks_(std::move(blocks)),
      viewed_(blocks_),
      kinds_(kinds),
      has_fronts_(model_->info().partly_oriented) {
  uint32_t first = 0;
  for (const ldc::BlockEntry& block : blocks_->tree().blocks()) {
    first_surfels_.push_back(first);
    first += block.items;
  }
  if (!kinds_.glyphs) return;
  const auto stored = model_->blocks();
  for (uint32_t block = 0; block < stored.size(); ++block) {
    const bool glyphs = blocks_->kind(block).drawn_as() == kinds::DrawnAs::kGlyphs;
    glyphs_.push_back(glyphs ? stored[block].items : 0);
  }
}

geometry::Camera Scene::camera_of(const picture::PictureRequest& request) const {
  if (request.camera) return *request.camera;
  return model::fit_model(*model_, static_cast<double>(request.width) / request.height);
}

ViewerHistory& Scene::history_of(uint64_t viewer, size_t most) {
  auto found = std::ranges::find(viewers_, viewer, &ViewerHistory::viewer);
  if (found == viewers_.end()) {
    if (viewers_.size() == most) viewers_.pop_back();
    found = viewers_.insert(viewers_.end(), {viewer, {}, {}});
  }
  viewers_.splice(viewers_.begin(), viewers_, found);
  return viewers_.front();
}

std::optional<geometry::CameraFrame> update_and_extrapolate(ViewerHistory& history, const geometry::Camera& camera,
                                                            int width, int height) {
  constexpr double kPicturesAhead = 4;  // about the latency from the request of a block to its first picture
  const std::optional<geometry::Camera> last = std::exchange(history.camera, camera);
  if (!last || (last->position == camera.position && last->focal_point == camera.focal_point)) return std::nullopt;
  geometry::Camera ahead = camera;
  ahead.position += kPicturesAhead * (camera.position - last->position);
  ahead.focal_point += kPicturesAhead * (camera.focal_point - last->focal_point);
  const Result<geometry::CameraFrame> frame = geometry::make_camera_frame(ahead, width, height);
  return frame ? std::optional(*frame) : std::nullopt;
}

}  // namespace surfcast::render
