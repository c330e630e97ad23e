#include "model/fit_model.h"

#include <algorithm>

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

Camera fit_model(const ModelFile& model, double aspect) {
  const glm::dvec3 up = model.info().z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  return fit_camera(box_of_discs(model), up, aspect, kViewAngle, mean_facing(model));
}

}  // namespace surfcast
