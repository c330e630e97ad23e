#include "geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

namespace surfcast {
namespace {

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::dvec3 least_aligned_axis(const glm::dvec3& direction) {
  const glm::dvec3 a = glm::abs(direction);
  if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
  return a.y <= a.z ? glm::dvec3{0, 1, 0} : glm::dvec3{0, 0, 1};
}

/// The length of v without overflow or underflow of the squares.
double safe_length(const glm::dvec3& v) {
  return std::hypot(v.x, v.y, v.z);
}

/// Distance from the middle of the box at which all its corners are in view with a margin.
double fitting_distance(const Box& box, const glm::dvec3& towards_eye, const glm::dvec3& up, double half_angle,
                        double aspect) {
  constexpr double kFilled = 0.92;  // of the picture
  const glm::dvec3 right = glm::normalize(glm::cross(up, towards_eye));
  const glm::dvec3 upward = glm::cross(towards_eye, right);
  const double tangent_y = kFilled * std::tan(half_angle);
  const double tangent_x = tangent_y * aspect;
  const glm::dvec3 half = 0.5 * box.size();
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) ? half.x : -half.x, (corner & 2) ? half.y : -half.y,
                       (corner & 4) ? half.z : -half.z);
    const double nearer = glm::dot(p, towards_eye);
    distance = std::max({distance, nearer + std::abs(glm::dot(p, right)) / tangent_x,
                         nearer + std::abs(glm::dot(p, upward)) / tangent_y, 1.05 * nearer});
  }
  return std::max(distance, 1e-12 + 1e-9 * glm::length(box.centre()));
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

Camera fit_camera(const Box& box, const glm::dvec3& up, double aspect, double view_angle, const glm::dvec3& facing) {
  const glm::dvec3 vertical = glm::normalize(up);
  // Front is -y for models that are z-up and +z for models that are y-up: the customs of surveying and of graphics.
  const glm::dvec3 front = std::abs(vertical.z) > 0.5 ? glm::dvec3{0, -1, 0} : glm::dvec3{0, 0, 1};
  const glm::dvec3 side = glm::cross(vertical, front);
  const glm::dvec3 customary = glm::normalize(front + 0.35 * side + 0.35 * vertical);
  constexpr double kPullOfNormals = 1.2;
  const glm::dvec3 towards_eye = glm::normalize(customary + kPullOfNormals * facing);
  Camera camera;
  camera.focal_point = box.centre();
  camera.view_up = vertical;
  camera.view_angle = view_angle;
  camera.position =
      box.centre() + towards_eye * fitting_distance(box, towards_eye, vertical, glm::radians(view_angle) / 2, aspect);
  return camera;
}

}  // namespace surfcast
