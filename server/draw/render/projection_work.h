#pragma once

#include <vector>

#include "render/depth_slices.h"
#include "render/region_task.h"

namespace surfcast::render {

/// The chunks of one kind, which its projection processes.
struct KindWork {
  size_t first = 0;  ///< index in ProjectionWork::chunks
  size_t count = 0;
};

/// The work of the projection.
struct ProjectionWork {
  std::vector<KindWork> kinds;  ///< for each kind of the picture
  std::vector<layout::BlockView> blocks;
  std::vector<layout::Chunk> chunks;
  std::vector<layout::BlockDisplay> block_displays;  ///< for each block, if the display options need them
  std::vector<layout::ClipRange> clips;
  std::vector<DepthRange> depths;  ///< of the blocks, in units of the projection
};

/// The binary exponent of the unit of length for a region. Pictures do not depend on the unit, but fourth powers of
/// lengths must stay within the range of single precision. The farthest surfel gets a distance of about 2^24, so
/// distances down to a billionth of it stay within that range. Scaling by a power of two does not round.
int drawing_unit(const RegionTask& task);
/// True if the display options have parameters for each block.
bool needs_block_displays(const DisplayOptions& display);
/// True if a region has a block that is drawn so.
bool has_blocks(const RegionTask& task, kinds::DrawnAs drawn_as);
/// The kinds of a region's blocks that are drawn so, sorted by number.
PictureKinds kinds_of(const RegionTask& task, kinds::DrawnAs drawn_as);
/// The work of these kinds, in the order of the region's blocks.
ProjectionWork plan_work(const RegionTask& task, const PictureKinds& kinds);

}  // namespace surfcast::render
