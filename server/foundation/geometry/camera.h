#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "base/result.h"

namespace surfcast::geometry {

/// A perspective camera as users state it: world coordinates of the source file in double precision.
struct Camera {
  glm::dvec3 position{0, 0, 1};
  glm::dvec3 focal_point{0, 0, 0};
  glm::dvec3 view_up{0, 1, 0};  ///< need not be unit or perpendicular to the view
  double view_angle = 30;       ///< vertical, degrees, in (0, 180)
};

/// The camera's own frame: origin at the eye, x right, y up, z forward, orthonormal.
/// A pixel with centre (px, py), counted from the top left corner, sees along (x, y, 1) with
/// x = (px - width/2) / eta and y = (height/2 - py) / eta.
struct CameraFrame {
  glm::dvec3 eye{0};      ///< world
  glm::dvec3 right{0};    ///< world, unit
  glm::dvec3 up{0};       ///< world, unit
  glm::dvec3 forward{0};  ///< world, unit
  double eta = 0;         ///< pixels per unit of tangent: height / (2 tan(view_angle / 2))
  int width = 0;          ///< pixels
  int height = 0;         ///< pixels

  /// World direction or eye-relative offset to camera coordinates.
  [[nodiscard]] glm::dvec3 rotate(const glm::dvec3& v) const {
    return {glm::dot(right, v), glm::dot(up, v), glm::dot(forward, v)};
  }
  [[nodiscard]] glm::dvec3 to_camera(const glm::dvec3& world) const { return rotate(world - eye); }
  /// Ray of a pixel position in camera coordinates, with z = 1.
  [[nodiscard]] glm::dvec3 ray(const glm::dvec2& pixel) const {
    return {(pixel.x - 0.5 * width) / eta, (0.5 * height - pixel.y) / eta, 1.0};
  }
  /// Pixel position of a point in camera coordinates with z > 0.
  [[nodiscard]] glm::dvec2 project(const glm::dvec3& p) const {
    return {0.5 * width + eta * p.x / p.z, 0.5 * height - eta * p.y / p.z};
  }
};

/// Checks the camera and derives its frame. Fails on non-finite values, a view angle outside (0, 180), or a focal point
/// at the eye. A view_up along the view direction is replaced by the axis least aligned with it.
Result<CameraFrame> make_camera_frame(const Camera& camera, int width, int height);

}  // namespace surfcast::geometry
