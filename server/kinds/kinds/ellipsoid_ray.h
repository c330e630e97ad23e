#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "geometry/camera.h"
#include "kinds/pixel_hits.h"

namespace surfcast::kinds {

/// Where a ray meets an ellipsoid first.
struct EllipsoidHit {
  double form = 0;       ///< squared distance of the ray's nearest point from the centre in parameter space, 0 to 1
  double depth = 0;      ///< camera z
  glm::dvec3 normal{0};  ///< camera frame, unit, out of the ellipsoid
};

/// An opaque ellipsoid in the camera frame: A u + c for |u| = 1. In parameter space it is a ball, and the nearest point
/// of a ray is found without cancellation, whatever the aspect ratio.
class EllipsoidOnRays {
 public:
  /// `axes`: unit vectors in the camera frame; `semi_axes`: world units, the first the longest and above 0. Shorter
  /// ones than a 10^12th of it count as that.
  EllipsoidOnRays(const glm::dvec3& centre, const glm::dmat3& axes, const glm::dvec3& semi_axes);

  /// The hit on the ray t * (x, y, 1), t > 0. None if it misses, or if the eye is within the ellipsoid.
  [[nodiscard]] std::optional<EllipsoidHit> on_ray(const glm::dvec3& ray) const;
  /// The pixels of a rectangle that it may cover: all if it reaches behind the plane of the eye.
  [[nodiscard]] PixelRange pixels(const geometry::CameraFrame& frame, const PixelRange& within) const;
  /// A lower bound of the depth.
  [[nodiscard]] double nearest_depth() const;

 private:
  glm::dvec3 centre_;
  glm::dmat3 axes_;
  glm::dvec3 semi_axes_;
  glm::dvec3 eye_;  ///< in parameter space
};

}  // namespace surfcast::kinds
