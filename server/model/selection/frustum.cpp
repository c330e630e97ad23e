#include "selection/frustum.h"

#include <algorithm>

namespace surfcast::selection {

Frustum::Frustum(const geometry::CameraFrame& frame, double x0, double y0, double x1, double y1) : eye_(frame.eye) {
  const glm::dvec3 low = frame.ray({x0, y1});  // y runs downwards in pixels, upwards in the camera frame
  const glm::dvec3 high = frame.ray({x1, y0});
  const auto world = [&frame](double x, double y, double z) {
    return glm::normalize(frame.right * x + frame.up * y + frame.forward * z);
  };
  inward_ = {world(1, 0, -low.x), world(-1, 0, high.x), world(0, 1, -low.y), world(0, -1, high.y), frame.forward};
}

bool Frustum::may_see(const geometry::Box& box, double margin) const {
  const glm::dvec3 low = box.min - eye_;
  const glm::dvec3 high = box.max - eye_;
  return std::all_of(inward_.begin(), inward_.end(), [&](const glm::dvec3& n) {
    const glm::dvec3 farthest(n.x > 0 ? high.x : low.x, n.y > 0 ? high.y : low.y, n.z > 0 ? high.z : low.z);
    return glm::dot(n, farthest) >= -margin;
  });
}

}  // namespace surfcast::selection
