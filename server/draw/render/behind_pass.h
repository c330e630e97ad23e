#pragma once

#include <cstdint>

#include "base/preemption.h"
#include "base/result.h"
#include "render/region_task.h"

namespace surfcast::render {

/// Makes room for every column of pixels, and the samples of every pixel, that the passes before may hand over
/// (shaders/include/unfinished.glsl). Nothing if the picture has no such pass.
void reserve_unfinished(const RegionTask& task, const SplatPrograms& programs, SplatBuffers& buffers);

/// Draws the columns that the passes before have handed over. `program` is null where nothing is. `per_group`: columns
/// of a work group.
Status draw_behind(const RegionTask& task, const gl::Program* program, uint32_t per_group, BatchSizer& sizer,
                   SplatBuffers& buffers, const Preemption& preemption);

}  // namespace surfcast::render
