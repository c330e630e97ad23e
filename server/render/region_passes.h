#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/preemption.h"
#include "base/result.h"
#include "kinds/kind_table.h"
#include "render/display_options.h"
#include "render/programs.h"
#include "render/region.h"
#include "render/splat_buffers.h"
#include "residency/surfel_buffer.h"
#include "residency/surfel_pool.h"
#include "selection/block_hull.h"

namespace surfcast::render {

/// A block to draw.
struct VisibleBlock {
  const residency::ResidentBlock* resident = nullptr;
  selection::RadiusRange radii;  ///< of the wanted spacing within the block
  uint32_t first_surfel = 0;     ///< its place in the model, see Scene::first_surfel
  uint32_t kind = 0;             ///< number in the table of kinds
};

/// One region to draw: what is seen, from where, how.
struct RegionTask {
  const residency::SurfelBuffer* surfels = nullptr;
  kinds::KindTable kinds;
  std::vector<VisibleBlock> blocks;
  geometry::CameraFrame frame;
  Region region;                     ///< that is wanted
  Region drawn;                      ///< the same, or with a margin of neighbours
  layout::FrameConstants constants;  ///< of `drawn`
  Variant variant;
  const picture::PictureRequest* request = nullptr;
  DisplayOptions display;
  const ConstantTexels* colors = nullptr;  ///< color_table of a look that is mapped
};

/// Milliseconds and counts of one region.
struct RegionStats {
  uint64_t splats = 0;
  double project_ms = 0;  ///< projection, culling, counting
  double bin_ms = 0;
  double splat_ms = 0;  ///< visibility, accumulation, normalisation, shading, eye-dome lighting
  double read_ms = 0;
};

/// Draws a region with the passes project, bin_offsets, bin, splat and perhaps silhouettes, supersample, and
/// eye_dome. Reads the pixels of `drawn`, or, after eye_dome, of `region` into `pixels` (4 bytes or 4 floats per pixel,
/// rows from the top).
Result<RegionStats> draw_region(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                const Preemption& preemption, std::span<std::byte> pixels);

}  // namespace surfcast::render
