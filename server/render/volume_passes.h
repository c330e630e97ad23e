#pragma once

#include "base/preemption.h"
#include "base/result.h"
#include "render/programs.h"
#include "render/region_passes.h"
#include "render/splat_buffers.h"
#include "render/volume_plan.h"

namespace surfcast::render {

/// The bricks of a region's blocks.
std::vector<VisibleBrick> bricks_of(const RegionTask& task);

/// Draws the volumes of a region into `buffers.picture`: the pixels of `written`. Each ray front to back, then the
/// Gaussian of one pixel over the light. `depth_unit`: of the depths of surfaces (Variant::layered), world units.
Status draw_volumes(const RegionTask& task, const Region& written, double depth_unit,
                    std::span<const VisibleBrick> bricks, Programs& programs, SplatBuffers& buffers,
                    const Preemption& preemption);

}  // namespace surfcast::render
