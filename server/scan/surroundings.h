#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scan/neighbours.h"

namespace surfcast::scan {

/// How its neighbours lie around a site, seen along its normal.
struct Surroundings {
  /// Distance to the nearest neighbour in that direction in which it is farthest, of eight directions; along a
  /// direction, the line halfway to a neighbour counts, which is farther the more the neighbour lies off it. Directions
  /// without any neighbour within 45 degrees do not count. Local units.
  double reach = 0;
  /// Unit, out of the surface, where the site lies on its border; otherwise zero.
  glm::dvec3 outwards{0};
};

/// The surroundings of every site. A site on a border has one wide angle without neighbours, and at least two of its
/// six nearest neighbours have one that opens to the same side: holes of an uneven sampling are open to a site, too,
/// but to each of those around them in a direction of its own.
std::vector<Surroundings> find_surroundings(const Sites& sites, const NeighbourGraph& graph,
                                            const std::vector<glm::vec3>& normals);

}  // namespace surfcast::scan
