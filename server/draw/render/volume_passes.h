#pragma once

#include "render/region_pass.h"

namespace surfcast::render {

/// Volumes: each ray front to back between what is drawn before, then the Gaussian of one pixel over the light.
extern const RegionPass kVolumePass;

}  // namespace surfcast::render
