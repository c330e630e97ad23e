#include "geometry/zone.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace surfcast::geometry {
namespace {

/// Whether the nearest point of the segment's line is on the segment, and within `reach`.
bool beside(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& point, double reach) {
  const glm::dvec2 along = to - from;
  const double square = glm::dot(along, along);
  if (square == 0) return false;
  const double share = glm::dot(point - from, along) / square;
  if (!(share >= 0 && share <= 1)) return false;
  const glm::dvec2 across = point - (from + share * along);
  return glm::dot(across, across) <= reach * reach;
}

bool near_corner(const glm::dvec2& corner, const glm::dvec2& point, double reach) {
  const glm::dvec2 step = point - corner;
  return glm::dot(step, step) <= reach * reach;
}

}  // namespace

bool contains(const Corridor& corridor, const glm::dvec3& point) {
  if (!(point.z >= corridor.low && point.z <= corridor.high)) return false;
  const std::vector<glm::dvec2>& line = corridor.line;
  const glm::dvec2 place(point);
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    if (beside(line[i], line[i + 1], place, corridor.half_width)) return true;
    if (i > 0 && near_corner(line[i], place, corridor.half_width)) return true;
  }
  return false;
}

bool contains(const Zone& zone, const glm::dvec3& point) {
  const auto holds = [&point](const auto& part) { return contains(part, point); };
  return (zone.boxes.empty() || std::any_of(zone.boxes.begin(), zone.boxes.end(), holds)) &&
         (zone.corridors.empty() || std::any_of(zone.corridors.begin(), zone.corridors.end(), holds));
}

Box bounds_of(const Corridor& corridor) {
  Box bounds;
  for (const glm::dvec2& corner : corridor.line) {
    bounds.include(glm::dvec3(corner - corridor.half_width, corridor.low));
    bounds.include(glm::dvec3(corner + corridor.half_width, corridor.high));
  }
  return bounds;
}

bool may_meet(const Zone& zone, const Box& box) {
  const auto meets = [&box](const Box& part) { return overlap(part, box); };
  const auto passes = [&box](const Corridor& part) { return overlap(bounds_of(part), box); };
  return (zone.boxes.empty() || std::any_of(zone.boxes.begin(), zone.boxes.end(), meets)) &&
         (zone.corridors.empty() || std::any_of(zone.corridors.begin(), zone.corridors.end(), passes));
}

}  // namespace surfcast::geometry
