#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "render/region_pass.h"

namespace surfcast::render {

/// A pass of a region.
struct PlannedPass {
  const RegionPass* pass = nullptr;
  PassPlaces places;
  std::vector<Place> cleared;  ///< layers that it is the first to use
};

/// The passes of all kinds, in the order of drawing.
std::span<const RegionPass* const> region_passes();

/// The places of the passes that a region needs: each draws between what the ones before it have left, and the last one
/// writes the picture.
std::vector<PlannedPass> plan_passes(std::span<const RegionPass* const> needed);

/// Draws a region with the passes that its blocks need, and reads the result into `pixels` (4 bytes or 4 floats per
/// pixel, rows from the top): the pixels of `drawn`, or with eye_dome those of `region`. None if the tile lists are too
/// long: the region must be drawn in parts.
Result<std::optional<RegionStats>> compose_region(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                                  const Preemption& preemption, std::span<std::byte> pixels);

}  // namespace surfcast::render
