#pragma once

#include <span>

#include "picture/depth_map.h"
#include "render/region.h"

namespace surfcast::render {

/// Enters the front surfaces of a region in the depth map of its picture. `fronts`: inverse depths of the pixels of
/// `drawn`, which contains the region; 0: none. They are multiplied by `unit`.
void add_fronts(std::span<const float> fronts, const Region& drawn, const Region& region, float unit,
                picture::DepthMap& map);

}  // namespace surfcast::render
