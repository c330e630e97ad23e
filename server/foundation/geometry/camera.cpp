#include "geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "geometry/finite.h"

namespace surfcast::geometry {
namespace {

glm::dvec3 least_aligned_axis(const glm::dvec3& direction) {
  const glm::dvec3 a = glm::abs(direction);
  if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
  return a.y <= a.z ? glm::dvec3{0, 1, 0} : glm::dvec3{0, 0, 1};
}

/// The length of v without overflow or underflow of the squares.
double safe_length(const glm::dvec3& v) {
  return std::hypot(v.x, v.y, v.z);
}

}  // namespace

Result<CameraFrame> make_camera_frame(const Camera& camera, int width, int height) {
  if (width < 1 || height < 1) return fail(ErrorKind::kInvalidInput, "resolution: must be at least 1 x 1");
  if (!finite(camera.position) || !finite(camera.focal_point) || !finite(camera.view_up)) {
    return fail(ErrorKind::kInvalidInput, "camera: coordinates must be finite numbers");
  }
  if (!(camera.view_angle > 0 && camera.view_angle < 180)) {
    return fail(ErrorKind::kInvalidInput, "camera: view angle must lie between 0 and 180 degrees");
  }
  const glm::dvec3 view = camera.focal_point - camera.position;
  const double distance = safe_length(view);
  if (!(distance > 0) || !std::isfinite(distance)) {
    return fail(ErrorKind::kInvalidInput, "camera: the focal point must differ from the position");
  }
  CameraFrame frame;
  frame.eye = camera.position;
  frame.forward = glm::normalize(view / distance);
  const double up_length = safe_length(camera.view_up);
  const glm::dvec3 up = up_length > 0 ? camera.view_up / up_length : least_aligned_axis(frame.forward);
  glm::dvec3 right = glm::cross(frame.forward, up);
  if (glm::length(right) < 1e-9) right = glm::cross(frame.forward, least_aligned_axis(frame.forward));
  frame.right = glm::normalize(right);
  frame.up = glm::cross(frame.right, frame.forward);
  frame.eta = height / (2 * std::tan(glm::radians(camera.view_angle) / 2));
  frame.width = width;
  frame.height = height;
  return frame;
}

}  // namespace surfcast::geometry
