#pragma once

#include <vector>

#include "warp/depth_plane.h"
#include "warp/pixels.h"

namespace surfcast::warp {

/// For each texel of a frame's depth, the colour that continues its surface where the frame does not show it: the mean
/// of the pixels up to two texels around that lie on the same surface.
std::vector<Color> fill_colors(const Pixels& pixels, const DepthPlane& depth);

}  // namespace surfcast::warp
