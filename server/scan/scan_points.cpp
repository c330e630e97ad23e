#include "scan/scan_points.h"

#include <cmath>

namespace surfcast {

Box finite_bounds(const std::vector<glm::dvec3>& positions) {
  Box box;
  for (const glm::dvec3& p : positions) {
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) box.include(p);
  }
  return box;
}

}  // namespace surfcast
