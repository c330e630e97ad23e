#pragma once

#include <cstdint>
#include <span>

#include "scan/classify_points.h"
#include "scan/sites.h"

namespace surfcast::scan {

/// The spread of a site and its neighbours, relative to the squared distance of the farthest one. `neighbours` must
/// not be empty.
Spread neighbour_spread(const Sites& sites, uint32_t site, std::span<const uint32_t> neighbours);

/// True if a site lies on no surface. `neighbours` are its nearest, nearest first. With fewer than kWideNeighbours
/// nothing is known, and the site counts as a surface.
bool is_scatter(const Sites& sites, uint32_t site, std::span<const uint32_t> neighbours);

}  // namespace surfcast::scan
