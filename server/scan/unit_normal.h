#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace surfcast::scan {

/// Unit, computed in double so that neither very short nor very long normals are lost; zero when there is none.
inline glm::vec3 unit_or_zero(const glm::vec3& normal) {
  const glm::dvec3 n(normal);
  const double length = glm::length(n);
  return std::isfinite(length) && length > 0 ? glm::vec3(n / length) : glm::vec3(0);
}

}  // namespace surfcast::scan
