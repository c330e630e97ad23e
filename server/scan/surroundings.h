#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scan/neighbours.h"

namespace surfcast::scan {

/// The arrangement of the neighbours around a site, projected along its normal.
struct Surroundings {
  /// The extent of the widest gap around the site, in local units. For each of eight directions, the minimum of d /
  /// cos(t) over the neighbours within 45 degrees, where d is the distance of a neighbour and t its angle to the
  /// direction. (This is twice the distance along the direction to the bisector between site and neighbour.) `reach` is
  /// the maximum over the directions. Directions without such a neighbour are skipped.
  double reach = 0;
  /// Unit vector out of the surface if the site lies on its border; otherwise zero.
  glm::dvec3 outwards{0};
};

/// The surroundings of every site. A site lies on a border if it has exactly one wide angle without neighbours, and at
/// least two of its six nearest neighbours have one that opens to the same side. Sites around a hole of an uneven
/// sampling have wide angles too, but each in a different direction.
std::vector<Surroundings> find_surroundings(const Sites& sites, const NeighbourGraph& graph,
                                            const std::vector<glm::vec3>& normals);

}  // namespace surfcast::scan
