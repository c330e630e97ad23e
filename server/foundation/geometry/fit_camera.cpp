#include "geometry/fit_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

namespace surfcast::geometry {
namespace {

/// Fits the eye along one axis of the picture: its offset on the axis and its distance from the focal point. A point at
/// `extent` on the axis and `nearer` in depth towards the eye (both relative to the focal point) is in the picture if
/// |extent - offset| <= tangent (distance - nearer). The tightest constraint on each side decides.
class AxisFit {
 public:
  explicit AxisFit(double tangent) : tangent_(tangent) {}
  void include(double extent, double nearer) {
    lowest_ = std::min(lowest_, extent - tangent_ * nearer);
    highest_ = std::max(highest_, extent + tangent_ * nearer);
  }
  [[nodiscard]] double offset() const { return (lowest_ + highest_) / 2; }
  [[nodiscard]] double distance() const { return (highest_ - lowest_) / (2 * tangent_); }

 private:
  double tangent_;
  double lowest_ = std::numeric_limits<double>::infinity();
  double highest_ = -std::numeric_limits<double>::infinity();
};

/// The unit direction from the fitted boxes to the eye.
glm::dvec3 fitting_direction(const glm::dvec3& vertical, const glm::dvec3& facing) {
  // By convention the front is -y in z-up models (surveying), +z in y-up models (graphics), and -z in models whose y
  // points down (cameras of training programs).
  const glm::dvec3 graphics{0, 0, vertical.y < 0 ? -1 : 1};
  const glm::dvec3 front = std::abs(vertical.z) > 0.5 ? glm::dvec3{0, -1, 0} : graphics;
  const glm::dvec3 side = glm::cross(vertical, front);
  const glm::dvec3 customary = glm::normalize(front + 0.35 * side + 0.35 * vertical);
  constexpr double kPullOfNormals = 1.2;
  return glm::normalize(customary + kPullOfNormals * facing);
}

Box box_of(std::span<const Box> boxes) {
  Box all;
  for (const Box& box : boxes) all.include(box);
  return all;
}

/// Corner 0 to 7: bits 0, 1 and 2 select the maximum along x, y and z.
glm::dvec3 corner_of(const Box& box, int corner) {
  return {(corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
          (corner & 4) ? box.max.z : box.min.z};
}

}  // namespace

Camera fit_along(std::span<const Box> boxes, const glm::dvec3& towards_eye, const glm::dvec3& up, double aspect,
                 double view_angle) {
  constexpr double kFilled = 0.95;  // share of the picture
  const CameraFrame axes = *make_camera_frame({glm::normalize(towards_eye), {0, 0, 0}, up, view_angle}, 1, 1);
  const glm::dvec3 centre = box_of(boxes).centre();
  const double tangent = kFilled * std::tan(glm::radians(view_angle) / 2);
  AxisFit across(tangent * aspect);
  AxisFit along(tangent);
  double distance = 1e-12 + 1e-9 * glm::length(centre);
  for (const Box& box : boxes) {
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p = axes.rotate(corner_of(box, corner) - centre);
      across.include(p.x, -p.z);
      along.include(p.y, -p.z);
      distance = std::max(distance, -1.05 * p.z);
    }
  }
  distance = std::max({distance, across.distance(), along.distance()});
  const glm::dvec3 focal_point = centre + axes.right * across.offset() + axes.up * along.offset();
  return {focal_point - axes.forward * distance, focal_point, up, view_angle};
}

Camera fit_camera(std::span<const Box> boxes, const glm::dvec3& up, double aspect, double view_angle,
                  const glm::dvec3& facing) {
  const glm::dvec3 vertical = glm::normalize(up);
  return fit_along(boxes, fitting_direction(vertical, facing), vertical, aspect, view_angle);
}

}  // namespace surfcast::geometry
