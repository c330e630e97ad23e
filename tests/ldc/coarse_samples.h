#pragma once

#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "ldc/coarse_surfel.h"
#include "surfel/even_sampling.h"

namespace surfcast::ldc {

inline CoarseSurfel surfel_at(const glm::dvec3& position, const glm::vec3& normal = {0, 0, 1}, float radius = 0.01F) {
  CoarseSurfel surfel;
  surfel.position = position;
  surfel.normal = normal;
  surfel.radius = radius;
  return surfel;
}

/// A square of side 1 with `side` x `side` surfels, whose middle is at `centre`. Its edges run along u and v.
inline std::vector<CoarseSurfel> sheet(int side, const glm::dvec3& centre, const glm::dvec3& u = {1, 0, 0},
                                       const glm::dvec3& v = {0, 1, 0}) {
  std::vector<CoarseSurfel> surfels;
  const glm::vec3 normal(glm::normalize(glm::cross(u, v)));
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const glm::dvec3 p = centre + u * ((i + 0.5) / side - 0.5) + v * ((j + 0.5) / side - 0.5);
      surfels.push_back(surfel_at(p, normal, static_cast<float>(surfel::kGridRadiusOverSpacing / side)));
    }
  }
  return surfels;
}

}  // namespace surfcast::ldc
