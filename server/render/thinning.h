#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/frame_layout.h"

namespace surfcast::render {

/// How the splats of overfull tiles are sampled (shaders/include/thinning.glsl).
struct Thinning {
  uint32_t most = 0;   ///< splats per tile; 0: no thinning
  bool alike = false;  ///< all splats with equal probability, also those of high gain
  bool operator==(const Thinning&) const = default;
};

/// The thinning to try after `tried` gave these counts; equal to `tried` if the counts are acceptable. `list_limit`:
/// the maximum number of entries of all lists together.
///
/// A splat is sampled by the demand of the tile of its centre, so a tile between less crowded ones may keep more splats
/// than it should. Its list must not exceed SURFCAST_TILE_CAPACITY_LIMIT, because software GL would end the loops over
/// it (see tile_spans.h): then fewer are kept everywhere.
Thinning next_thinning(const layout::Counters& counters, const Thinning& tried, size_t list_limit);

}  // namespace surfcast::render
