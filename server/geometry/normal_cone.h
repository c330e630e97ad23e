#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>

namespace surfcast::geometry {

/// Holds a set of unit normals: all are within `half_angle` of the axis.
struct NormalCone {
  glm::vec3 axis{0, 0, 1};  ///< unit
  float half_angle = 0;     ///< radians, in [0, pi]
};

/// The cone about the mean direction; none when there are no normals or their mean vanishes.
std::optional<NormalCone> normal_cone(std::span<const glm::vec3> normals);

/// A cone that holds both; none when it would hold half of all directions, since it then rules nothing out.
std::optional<NormalCone> united(const NormalCone& a, const NormalCone& b);

}  // namespace surfcast::geometry
