#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "estimation/sites.h"

namespace surfcast::estimation {

/// What a link of two sites says about the signs of their normals, in [-1, 1]: positive if they agree. It compares the
/// components of the two normals perpendicular to the link (see propagate_signs.h). Sites do not coincide.
inline double sign_vote(const Sites& sites, std::span<const glm::vec3> normals, uint32_t a, uint32_t b) {
  const glm::dvec3 d = sites.positions[b] - sites.positions[a];
  const glm::dvec3 n(normals[a]);
  const glm::dvec3 m(normals[b]);
  return glm::dot(n, m) - glm::dot(n, d) * glm::dot(m, d) / glm::dot(d, d);
}

}  // namespace surfcast::estimation
