#include "reference/ray_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace surfcast::reference {

SurfacePoint square_point(const glm::dvec2& xy) {
  return {{xy.x, xy.y, 0}, {0, 0, 1}, 0.5 * (xy + 1.0)};
}

SurfacePoint sphere_point(const glm::dvec3& direction) {
  const glm::dvec3 n = glm::normalize(direction);
  const double u = 0.5 + std::atan2(n.y, n.x) / (2 * std::numbers::pi);
  return {n, n, {u, 0.5 + std::asin(std::clamp(n.z, -1.0, 1.0)) / std::numbers::pi}};
}

RaySurface square() {
  return [](const glm::dvec3& origin, const glm::dvec3& direction) -> std::optional<SurfacePoint> {
    const double t = -origin.z / direction.z;
    if (!(t > 0)) return std::nullopt;
    const glm::dvec2 xy{origin.x + t * direction.x, origin.y + t * direction.y};
    if (!(std::abs(xy.x) <= 1 && std::abs(xy.y) <= 1)) return std::nullopt;
    return square_point(xy);
  };
}

RaySurface unit_sphere() {
  return [](const glm::dvec3& origin, const glm::dvec3& direction) -> std::optional<SurfacePoint> {
    const glm::dvec3 d = glm::normalize(direction);
    const double along = -glm::dot(origin, d);
    const double square = 1 - glm::dot(origin + along * d, origin + along * d);
    if (square < 0 || along - std::sqrt(square) <= 0) return std::nullopt;
    return sphere_point(origin + (along - std::sqrt(square)) * d);
  };
}

}  // namespace surfcast::reference
