#pragma once

#include <optional>
#include <span>

#include "render/region_passes.h"

namespace surfcast::render {

/// Draws a region of ellipsoids, as draw_region does with one of surfels: projects them, sorts them by depth into the
/// lists of the tiles, finds the nearest one in every sample, lights it, and filters the samples. None if lists are too
/// long. Surfaces of the region are drawn before, and kept in layers: each sample tells which of them are before its
/// hit. Then eye-dome lighting and supersampled silhouettes of the surfaces are left out.
Result<std::optional<RegionStats>> draw_ellipsoids(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                                   const Preemption& preemption, std::span<std::byte> pixels);

/// Adds the ellipsoids of a region to the surfaces in `buffers.volume.layers`, as one surface of each pixel, for
/// volumes and Gaussians, which are drawn between surfaces. None if lists are too long.
Result<std::optional<RegionStats>> add_ellipsoids(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                                  const Preemption& preemption);

}  // namespace surfcast::render
