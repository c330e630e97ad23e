#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>

namespace surfcast::geometry {

/// A cone that contains a set of unit normals: all are within `half_angle` of the axis.
struct NormalCone {
  glm::vec3 axis{0, 0, 1};  ///< unit
  float half_angle = 0;     ///< radians, in [0, pi]
};

/// The cone around the mean direction. None when there are no normals or their mean vanishes.
std::optional<NormalCone> normal_cone(std::span<const glm::vec3> normals);

/// A cone that contains both. None when it would cover half of all directions or more, since it then culls nothing.
std::optional<NormalCone> united(const NormalCone& a, const NormalCone& b);

}  // namespace surfcast::geometry
