#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scan/neighbours.h"

namespace surfcast::scan {

/// The radius of each site, in world units: the distance that its kernel has to cover. It is the mean distance to the
/// six nearest neighbours (to all of them if there are fewer), with these exceptions:
/// - Where the sampling is uneven it is larger, so that the surface has no gaps.
/// - On the border of a surface it is smaller, because there is no surface beyond to be covered.
/// - For outliers off a surface it is limited to a few times the radius of the sites on the surface.
/// - A single site has no spacing and gets 1, which makes it visible at a distance of a few units.
///
/// docs/kernel.md has measurements of each rule.
std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph,
                                  const std::vector<glm::vec3>& normals);

/// Clamps to the range of float, because world units may exceed it. A radius is neither 0 nor infinite.
float to_radius(double length);

}  // namespace surfcast::scan
