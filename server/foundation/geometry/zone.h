#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/box.h"

namespace surfcast::geometry {

/// What lies near a line, seen from above (along z): round at its corners, cut off straight at its two ends. Lengths
/// and coordinates are those of the points.
struct Corridor {
  std::vector<glm::dvec2> line;  ///< x and y of its corners, two at least
  double half_width = 0;         ///< largest horizontal distance from the line
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// A part of space: what lies in one of the boxes and in one of the corridors. Without boxes, or corridors, these do
/// not limit it; without both it is everywhere. Ends are included.
struct Zone {
  std::vector<Box> boxes;
  std::vector<Corridor> corridors;

  [[nodiscard]] bool everywhere() const { return boxes.empty() && corridors.empty(); }
};

[[nodiscard]] inline bool contains(const Box& box, const glm::dvec3& point) {
  return point.x >= box.min.x && point.x <= box.max.x && point.y >= box.min.y && point.y <= box.max.y &&
         point.z >= box.min.z && point.z <= box.max.z;
}

[[nodiscard]] inline bool overlap(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

/// False for points with a coordinate that is no number.
[[nodiscard]] bool contains(const Corridor& corridor, const glm::dvec3& point);
[[nodiscard]] bool contains(const Zone& zone, const glm::dvec3& point);

/// A box around all of the corridor.
[[nodiscard]] Box bounds_of(const Corridor& corridor);

/// False only if no point of the box lies in the zone.
[[nodiscard]] bool may_meet(const Zone& zone, const Box& box);

}  // namespace surfcast::geometry
