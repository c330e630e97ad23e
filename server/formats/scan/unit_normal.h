#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace surfcast::scan {

/// The normalised vector. Computed in double, because very short or long normals would underflow or overflow. Zero if
/// the input has no direction.
inline glm::vec3 unit_or_zero(const glm::vec3& normal) {
  const glm::dvec3 n(normal);
  const double length = glm::length(n);
  return std::isfinite(length) && length > 0 ? glm::vec3(n / length) : glm::vec3(0);
}

}  // namespace surfcast::scan
