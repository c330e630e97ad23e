#include "model/fit_model.h"

#include <algorithm>
#include <vector>

#include "geometry/fit_camera.h"

namespace surfcast::model {
namespace {

constexpr double kViewAngle = 30;  // degrees, of the default camera

/// Mean normal of the whole model, from the cones of its leaves; zero if the model is not oriented.
glm::dvec3 mean_facing(const ModelFile& model) {
  glm::dvec3 sum(0);
  for (const ldc::BlockEntry& block : model.blocks()) {
    if (block.level == 0 && block.normals) sum += glm::dvec3(block.normals->axis) * static_cast<double>(block.surfels);
  }
  return sum / static_cast<double>(std::max<uint64_t>(model.info().surfels, 1));
}

/// The bounding boxes of all leaves, including their discs. Together they follow the surface more closely than the
/// model's own box, whose corners are mostly empty.
std::vector<geometry::Box> boxes_of_discs(const ModelFile& model) {
  std::vector<geometry::Box> boxes;
  for (const ldc::BlockEntry& block : model.blocks()) {
    if (block.level > 0) continue;
    boxes.push_back({block.bounds.min - block.max_radius, block.bounds.max + block.max_radius});
  }
  return boxes;
}

}  // namespace

geometry::Camera fit_model(const ModelFile& model, double aspect) {
  const glm::dvec3 up = model.info().z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  return geometry::fit_camera(boxes_of_discs(model), up, aspect, kViewAngle, mean_facing(model));
}

}  // namespace surfcast::model
