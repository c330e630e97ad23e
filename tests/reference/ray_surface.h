#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace surfcast::reference {

/// A point of an analytic surface.
struct SurfacePoint {
  glm::dvec3 position{0};
  glm::dvec3 normal{0};  ///< unit, outwards
  glm::dvec2 uv{0};      ///< in [0, 1]^2
};

/// Finds the nearest point of the surface in front of `origin` along `direction`.
using RaySurface = std::function<std::optional<SurfacePoint>(const glm::dvec3& origin, const glm::dvec3& direction)>;

/// The square [-1, 1]^2 of the plane z = 0, seen from both sides, normal +z.
RaySurface square();
/// The unit sphere about the origin; u is the longitude about z, v the latitude.
RaySurface unit_sphere();

SurfacePoint square_point(const glm::dvec2& xy);
SurfacePoint sphere_point(const glm::dvec3& direction);

}  // namespace surfcast::reference
