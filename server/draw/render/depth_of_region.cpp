#include "render/depth_of_region.h"

#include <algorithm>
#include <cstddef>

namespace surfcast::render {

void add_fronts(std::span<const float> fronts, const Region& drawn, const Region& region, float unit,
                picture::DepthMap& map) {
  const int end = region.x + region.width;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const float* row = fronts.data() + static_cast<ptrdiff_t>(y - drawn.y) * drawn.width - drawn.x;
    float* texels = map.inverse.data() + static_cast<ptrdiff_t>(y / map.cell) * map.width;
    for (int x = region.x; x < end;) {
      float& texel = texels[x / map.cell];
      const int stop = std::min((x / map.cell + 1) * map.cell, end);
      float nearest = 0;
      for (; x < stop; ++x) nearest = std::max(nearest, row[x]);
      texel = std::max(texel, nearest * unit);
    }
  }
}

}  // namespace surfcast::render
