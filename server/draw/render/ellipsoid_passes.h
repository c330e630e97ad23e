#pragma once

#include "render/region_pass.h"

namespace surfcast::render {

/// Ellipsoids: projects them, sorts them by depth into the lists of the tiles, finds the nearest one in every sample,
/// lights it, and filters the samples. Beside surfaces each sample tells which of them are before its hit. Before
/// volumes and Gaussians the ellipsoids become one more surface of each pixel.
extern const RegionPass kEllipsoidPass;

}  // namespace surfcast::render
