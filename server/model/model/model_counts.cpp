#include "model/model_counts.h"

#include <algorithm>
#include <vector>

namespace surfcast::model {

void count_blocks(std::span<const ldc::BlockEntry> blocks, ModelInfo& info) {
  const int up_axis = info.z_up ? 2 : 1;
  std::vector<ElevationSlab> slabs;  // but for volumes, which are not colored by elevation
  for (const ldc::BlockEntry& block : blocks) {
    info.levels = std::max(info.levels, block.level + 1);
    KindCount& kind = info.kinds[block.kind];
    ++kind.blocks;
    if (block.level > 0) continue;
    info.bounds.include(block.bounds);
    kind.items += block.items;
    if (kind.kind != kGridKind) {
      slabs.push_back({{block.bounds.min[up_axis], block.bounds.max[up_axis]}, block.items});
    }
  }
  info.elevation = elevation_range(slabs);
  for (const KindCount& kind : info.kinds) {
    if (kind.kind == kSurfelKind) info.surfels = kind.items;
  }
}

}  // namespace surfcast::model
