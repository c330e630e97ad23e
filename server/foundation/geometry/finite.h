#pragma once

#include <cmath>
#include <glm/vec3.hpp>

namespace surfcast::geometry {

[[nodiscard]] inline bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace surfcast::geometry
