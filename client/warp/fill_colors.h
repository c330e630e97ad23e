#pragma once

#include <vector>

#include "warp/depth_plane.h"
#include "warp/pixels.h"

namespace surfcast::warp {

/// For each texel of a frame's depth, the colour with which holes beside its surface are filled: the mean of the pixels
/// of that surface up to two texels around.
std::vector<Color> fill_colors(const Pixels& pixels, const DepthPlane& depth);

}  // namespace surfcast::warp
