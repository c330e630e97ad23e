#pragma once

#include "base/preemption.h"
#include "base/result.h"
#include "render/region_task.h"
#include "render/tile_spans.h"

namespace surfcast::render {

/// The programs of a picture. Those for long lists are null where there are none.
struct RegionPrograms {
  SplatPrograms lanes;
  LongListPrograms groups;
};

/// True if some tiles have long lists.
bool has_long_lists(const layout::Counters& counters);

/// Binds the buffers of the passes that draw tiles or pixels.
void bind_for_splatting(const RegionTask& task, const SplatBuffers& buffers);

/// Draws a span of tiles with a variant of the splat kernel.
Status draw_tiles(const RegionTask& task, const TileSpan& span, const gl::Program& program, BatchSizer& sizer,
                  SplatBuffers& buffers, const Preemption& preemption);

/// Draws all tiles of a region, with the surfaces behind the first ones.
Status splat(const RegionTask& task, const layout::Counters& counters, const RegionPrograms& programs,
             const KernelShape& shape, SplatBuffers& buffers, const Preemption& preemption);

}  // namespace surfcast::render
