#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/box.h"

namespace surfcast::scan {

/// The points of a scan that are wanted.
struct Selection {
  std::optional<geometry::Box> bounds;  ///< coordinates of the file, ends included; none: everywhere
  std::vector<uint8_t> classes;         ///< of the attribute "classification"; empty: all
  uint64_t every = 1;                   ///< of each piece that the file is read in, every n-th point

  [[nodiscard]] bool everything() const { return !bounds && classes.empty() && every <= 1; }
};

[[nodiscard]] inline bool contains(const geometry::Box& box, const glm::dvec3& point) {
  return point.x >= box.min.x && point.x <= box.max.x && point.y >= box.min.y && point.y <= box.max.y &&
         point.z >= box.min.z && point.z <= box.max.z;
}

[[nodiscard]] inline bool overlap(const geometry::Box& a, const geometry::Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

}  // namespace surfcast::scan
