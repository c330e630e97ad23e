#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace surfcast::reference {

/// Albedo of models without colour, linear light. The light comes from the eye.
inline constexpr double kAlbedo = 0.8;
inline constexpr double kAmbient = 0.1;  ///< ambient share of the light, independent of the normal

/// Brightness of a surface with this normal, seen along the ray, in [kAmbient, 1].
inline double headlight(const glm::dvec3& normal, const glm::dvec3& ray) {
  const double lengths = glm::length(normal) * glm::length(ray);
  const double cosine = lengths > 0 ? std::abs(glm::dot(normal, ray)) / lengths : 0;
  return kAmbient + (1 - kAmbient) * cosine;
}

}  // namespace surfcast::reference
