#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace surfcast::reference {

/// Grey of models without colour, lit along the viewing ray, linear light.
inline constexpr double kAlbedo = 0.8;
inline constexpr double kAmbient = 0.1;  ///< share of the light that ignores the normal

/// Share of the light that a surface sends back along the ray.
inline double headlight(const glm::dvec3& normal, const glm::dvec3& ray) {
  const double lengths = glm::length(normal) * glm::length(ray);
  const double cosine = lengths > 0 ? std::abs(glm::dot(normal, ray)) / lengths : 0;
  return kAmbient + (1 - kAmbient) * cosine;
}

}  // namespace surfcast::reference
