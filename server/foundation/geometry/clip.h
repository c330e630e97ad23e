#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/box.h"

namespace surfcast::geometry {

/// The clipped part of the world: a picture shows points that lie in at least one box of `inside` (everywhere if it is
/// empty) and in no box of `outside`. A box includes its faces.
struct Clip {
  std::vector<Box> inside;
  std::vector<Box> outside;

  /// True when nothing is clipped.
  [[nodiscard]] bool empty() const { return inside.empty() && outside.empty(); }

  [[nodiscard]] bool shows(const glm::dvec3& point) const {
    const auto holds = [&point](const Box& box) { return contains(box, {point, point}); };
    return (inside.empty() || std::any_of(inside.begin(), inside.end(), holds)) &&
           std::none_of(outside.begin(), outside.end(), holds);
  }

  /// False only if no point of the box is shown.
  [[nodiscard]] bool may_show(const Box& points) const {
    const auto meets = [&points](const Box& box) { return touch(box, points); };
    const auto holds = [&points](const Box& box) { return contains(box, points); };
    return (inside.empty() || std::any_of(inside.begin(), inside.end(), meets)) &&
           std::none_of(outside.begin(), outside.end(), holds);
  }

  static bool contains(const Box& box, const Box& inner) {
    return box.min.x <= inner.min.x && box.min.y <= inner.min.y && box.min.z <= inner.min.z &&
           box.max.x >= inner.max.x && box.max.y >= inner.max.y && box.max.z >= inner.max.z;
  }
  static bool touch(const Box& a, const Box& b) {
    return a.min.x <= b.max.x && a.min.y <= b.max.y && a.min.z <= b.max.z && a.max.x >= b.min.x && a.max.y >= b.min.y &&
           a.max.z >= b.min.z;
  }
};

}  // namespace surfcast::geometry
