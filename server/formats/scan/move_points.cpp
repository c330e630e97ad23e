#include "scan/move_points.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace surfcast::scan {

void move_points(const glm::dmat4& transform, std::vector<glm::dvec3>& positions) {
  if (transform == glm::dmat4(1)) return;
  for (glm::dvec3& position : positions) {
    // Summed from left to right, as other readers do: to the last bit.
    position = ((glm::dvec3(transform[0]) * position.x + glm::dvec3(transform[1]) * position.y) +
                glm::dvec3(transform[2]) * position.z) +
               glm::dvec3(transform[3]);
  }
}

void turn_normals(const glm::dmat4& transform, std::vector<glm::dvec3>& normals) {
  if (transform == glm::dmat4(1)) return;
  const glm::dmat3 turning = glm::transpose(glm::inverse(glm::dmat3(transform)));
  for (glm::dvec3& normal : normals) {
    normal = turning * normal;
    const double length = glm::length(normal);
    if (length > 0) normal /= length;
  }
}

}  // namespace surfcast::scan
