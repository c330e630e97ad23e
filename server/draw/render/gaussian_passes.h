#pragma once

#include "render/region_pass.h"

namespace surfcast::render {

/// Gaussians: projects them, sorts them by depth into the lists of the tiles, and blends them between the surfaces of
/// the region. Volumes among Gaussians are blended in the same way in all regions of a picture, so they need this pass
/// in regions without Gaussians, too.
extern const RegionPass kGaussianPass;

}  // namespace surfcast::render
