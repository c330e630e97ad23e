#include "render/scene.h"

#include <utility>

#include "model/fit_model.h"

namespace surfcast {
Scene::Scene(std::shared_ptr<const ModelFile> model)
    : model_(std::move(model)), viewed_(std::make_shared<const FileBlocks>(model_)) {
  uint32_t first = 0;
  for (const BlockEntry& block : model_->blocks()) {
    first_surfels_.push_back(first);
    first += block.surfels;
  }
}

Camera Scene::camera_of(const PictureRequest& request) const {
  if (request.camera) return *request.camera;
  return fit_model(*model_, static_cast<double>(request.width) / request.height);
}

ViewerMemory& Scene::memory_of(uint64_t viewer) {
  constexpr size_t kViewers = 64;
  auto found = std::ranges::find(viewers_, viewer, &ViewerMemory::viewer);
  if (found == viewers_.end()) {
    if (viewers_.size() == kViewers) viewers_.pop_back();
    found = viewers_.insert(viewers_.end(), {viewer, {}, {}});
  }
  viewers_.splice(viewers_.begin(), viewers_, found);
  return viewers_.front();
}

std::optional<CameraFrame> move_to(ViewerMemory& memory, const Camera& camera, int width, int height) {
  constexpr double kPicturesAhead = 4;  // about as long as a block takes from being wished for to being drawn
  const std::optional<Camera> last = std::exchange(memory.camera, camera);
  if (!last || (last->position == camera.position && last->focal_point == camera.focal_point)) return std::nullopt;
  Camera ahead = camera;
  ahead.position += kPicturesAhead * (camera.position - last->position);
  ahead.focal_point += kPicturesAhead * (camera.focal_point - last->focal_point);
  const Result<CameraFrame> frame = make_camera_frame(ahead, width, height);
  return frame ? std::optional(*frame) : std::nullopt;
}

}  // namespace surfcast
