#include "geometry/normal_cone.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace surfcast {

std::optional<NormalCone> normal_cone(std::span<const glm::vec3> normals) {
  glm::dvec3 sum{0};
  for (const glm::vec3& n : normals) sum += glm::dvec3(n);
  const double length = glm::length(sum);
  if (normals.empty() || length < 1e-6 * static_cast<double>(normals.size())) return std::nullopt;
  const glm::vec3 axis(sum / length);
  double widest = 0;
  for (const glm::vec3& n : normals) {
    // atan2 keeps small angles exact where acos loses them.
    const glm::dvec3 a(axis);
    const glm::dvec3 b(n);
    widest = std::max(widest, std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  }
  const float rounded_up = std::nextafter(static_cast<float>(widest), 4.0f);
  return NormalCone{axis, std::min(rounded_up, std::numbers::pi_v<float>)};
}

}  // namespace surfcast
