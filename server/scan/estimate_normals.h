#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scan/neighbours.h"

namespace surfcast::scan {

/// The direction of least variance of each site's neighbourhood (Hoppe et al. 1992, section 3.2): the eigenvector of
/// the smallest eigenvalue of the covariance of the site and its neighbours. Unit; the sign is arbitrary.
/// Neighbourhoods on a line get a direction perpendicular to it. A single site gets z.
std::vector<glm::vec3> estimate_normals(const Sites& sites, const NeighbourGraph& graph);

}  // namespace surfcast::scan
