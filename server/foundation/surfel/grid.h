#pragma once

#include <cmath>
#include <glm/vec3.hpp>

namespace surfcast::surfel {

/// A lattice of exact coordinates: axis i of a stored point is `index[i] * scale[i] + offset[i]`. The expression is
/// evaluated in double precision in this form (the formula of LAS), which reproduces coordinates to the last bit.
struct Grid {
  glm::dvec3 scale{1};
  glm::dvec3 offset{0};

  [[nodiscard]] glm::dvec3 position(const glm::i64vec3& index) const {
    return {static_cast<double>(index.x) * scale.x + offset.x, static_cast<double>(index.y) * scale.y + offset.y,
            static_cast<double>(index.z) * scale.z + offset.z};
  }
  /// The nearest lattice point. The caller guarantees indices within +-2^62.
  [[nodiscard]] glm::i64vec3 index(const glm::dvec3& p) const {
    return {std::llround((p.x - offset.x) / scale.x), std::llround((p.y - offset.y) / scale.y),
            std::llround((p.z - offset.z) / scale.z)};
  }
  bool operator==(const Grid&) const = default;
};

}  // namespace surfcast::surfel
