#pragma once

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace surfcast::geometry {

/// An axis-aligned box in world coordinates (units of the source file). Empty until something is included.
struct Box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  void include(const glm::dvec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void include(const Box& other) {
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
  }
  [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  [[nodiscard]] glm::dvec3 centre() const { return 0.5 * min + 0.5 * max; }
  [[nodiscard]] glm::dvec3 size() const { return max - min; }
  /// Length of the diagonal.
  [[nodiscard]] double diagonal() const { return glm::length(size()); }
};

}  // namespace surfcast::geometry
