#include "render/scene.h"

#include <algorithm>
#include <utility>

namespace surfcast {
namespace {

constexpr double kViewAngle = 30;  // degrees, of the view that is chosen when none is asked for

/// Mean normal of the whole model, from the cones of its leaves; zero where front and back are not known.
glm::dvec3 mean_facing(const ModelFile& model) {
  glm::dvec3 sum(0);
  for (const BlockEntry& block : model.blocks()) {
    if (block.level == 0 && block.normals) sum += glm::dvec3(block.normals->axis) * static_cast<double>(block.surfels);
  }
  return sum / static_cast<double>(std::max<uint64_t>(model.info().surfels, 1));
}

/// The finest level with its discs.
Box box_of_discs(const ModelFile& model) {
  Box box = model.info().bounds;
  double reach = 0;
  for (const BlockEntry& block : model.blocks()) {
    if (block.level == 0) reach = std::max(reach, block.max_radius);
  }
  box.min -= reach;
  box.max += reach;
  return box;
}

}  // namespace

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
  const glm::dvec3 up = model_->info().z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  return fit_camera(box_of_discs(*model_), up, static_cast<double>(request.width) / request.height, kViewAngle,
                    mean_facing(*model_));
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
