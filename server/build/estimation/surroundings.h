#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "estimation/neighbour_offsets.h"

namespace surfcast::estimation {

/// The arrangement of the neighbours around a site, projected along its normal.
struct Surroundings {
  /// The extent of the widest gap around the site, in local units. For each of eight directions, the minimum of d /
  /// cos(t) over the neighbours within 45 degrees, where d is the distance of a neighbour and t its angle to the
  /// direction. (This is twice the distance along the direction to the bisector between site and neighbour.) `reach` is
  /// the maximum over the directions. Directions without such a neighbour are skipped.
  double reach = 0;
  /// Unit vector along the bisector of the wide angle without neighbours if there is exactly one; otherwise zero.
  glm::dvec3 opening{0};
};

/// The arrangement of the `count` nearest neighbours; at most 16 are looked at.
Surroundings find_surroundings(const NeighbourOffsets& neighbours, size_t count, const glm::dvec3& normal);

}  // namespace surfcast::estimation
