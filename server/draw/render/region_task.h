#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kinds/kind_table.h"
#include "render/display_options.h"
#include "render/programs.h"
#include "render/region.h"
#include "render/splat_buffers.h"
#include "residency/block_memory.h"
#include "residency/block_pool.h"
#include "selection/block_hull.h"
#include "selection/visible_depths.h"

namespace surfcast::render {

/// A block to draw.
struct VisibleBlock {
  const residency::ResidentBlock* resident = nullptr;
  selection::RadiusRange radii;  ///< radii at the requested spacing within the block
  uint32_t first_surfel = 0;     ///< index of its first surfel in the model, see Scene::first_surfel
  uint32_t kind = 0;             ///< number in the table of kinds
  bool coarse = false;           ///< it stands in for finer ones, and need not be drawn exactly
};

/// All inputs for drawing one region.
struct RegionTask {
  const residency::BlockMemory* surfels = nullptr;
  kinds::KindTable kinds;
  std::vector<VisibleBlock> blocks;
  geometry::CameraFrame frame;
  Region region;                     ///< requested pixels
  Region drawn;                      ///< `region`, or `region` with a margin of neighbouring pixels
  layout::FrameConstants constants;  ///< of `drawn`
  Variant variant;
  const picture::PictureRequest* request = nullptr;
  DisplayOptions display;
  const ConstantTexels* colors = nullptr;     ///< color_table of `display`, if it is mapped
  size_t list_entries = 0;                    ///< the most entries of all tile lists together
  picture::DepthMap* depth = nullptr;         ///< with Variant::depth: of the picture; the region's surfaces are added
  selection::VisibleDepths* shown = nullptr;  ///< with Variant::shown_depths: of the picture, likewise
  bool among_gaussians = false;               ///< the picture has Gaussians, whether or not the region does
};

/// Milliseconds and counts of one region.
struct RegionStats {
  uint64_t splats = 0;
  double project_ms = 0;  ///< projection, culling, counting
  double bin_ms = 0;
  double splat_ms = 0;  ///< visibility, accumulation, normalisation, shading, eye-dome lighting
  double read_ms = 0;

  RegionStats& operator+=(const RegionStats& more) {
    splats += more.splats;
    project_ms += more.project_ms;
    bin_ms += more.bin_ms;
    splat_ms += more.splat_ms;
    read_ms += more.read_ms;
    return *this;
  }
};

}  // namespace surfcast::render
