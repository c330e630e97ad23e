#pragma once

#include <vector>

#include "scan/neighbours.h"

namespace surfcast {

/// The mean distance from each site to its six nearest neighbours, in world units; to as many as there are when there
/// are fewer. Sites that float off a surface get a few times the radius of its sites at most. A single site has no
/// spacing: it gets 1, so that it can be seen at a distance of a few units.
std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph);

}  // namespace surfcast
