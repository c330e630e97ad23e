#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

namespace surfcast::reference {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace surfcast::reference
