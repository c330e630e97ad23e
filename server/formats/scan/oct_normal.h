#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace surfcast::scan {

/// The unit vector of a point of the square from -1 to 1 onto which the octahedron is unfolded (Meyer et al. 2010).
[[nodiscard]] inline glm::vec3 oct_normal(double x, double y) {
  const double z = 1 - std::abs(x) - std::abs(y);
  const double below = z < 0 ? -z : 0;
  const glm::dvec3 folded(x + (x >= 0 ? -below : below), y + (y >= 0 ? -below : below), z);
  return glm::normalize(folded);
}

}  // namespace surfcast::scan
