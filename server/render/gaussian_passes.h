#pragma once

#include <optional>
#include <span>

#include "render/region_passes.h"

namespace surfcast::render {

/// Draws a region of Gaussians, as draw_region does with one of surfels: projects them, sorts them by depth into the
/// lists of the tiles, and blends them, between the surfaces of the region if it has any. None if lists are too long.
/// Eye-dome lighting and supersampled silhouettes of the surfaces are left out.
Result<std::optional<RegionStats>> draw_gaussians(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                                  const Preemption& preemption, std::span<std::byte> pixels);

}  // namespace surfcast::render
