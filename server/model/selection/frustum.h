#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "geometry/box.h"
#include "geometry/camera.h"

namespace surfcast::selection {

/// The view frustum of a rectangle of pixels: four planes through the eye and the sides of the rectangle, and the plane
/// through the eye. Planes are relative to the eye, so precision does not depend on the size of world coordinates.
class Frustum {
 public:
  /// The rectangle [x0, x1] x [y0, y1], pixels from the top left corner.
  Frustum(const geometry::CameraFrame& frame, double x0, double y0, double x1, double y1);

  /// Conservative: false only if the box, grown by `margin` world units on all sides, is outside.
  [[nodiscard]] bool may_see(const geometry::Box& box, double margin) const;

 private:
  glm::dvec3 eye_;
  std::array<glm::dvec3, 5> inward_;  ///< unit normals
};

}  // namespace surfcast::selection
