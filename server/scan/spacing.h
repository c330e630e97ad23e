#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scan/neighbours.h"

namespace surfcast::scan {

/// What the kernel of a site is to reach, in world units: the mean distance to its six nearest neighbours, or to as
/// many as there are when there are fewer; more where the sampling is uneven, so that no gap opens to any side; less on
/// the border of a surface, where nothing is to be reached beyond it. docs/kernel.md has what each is worth. Sites that
/// float off a surface get a few times the radius of its sites at most. A single site has no spacing: it gets 1, so
/// that it can be seen at a distance of a few units.
std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph,
                                  const std::vector<glm::vec3>& normals);

}  // namespace surfcast::scan
