#pragma once

#include <cstddef>
#include <optional>
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
  selection::RadiusRange radii;  ///< radii at the requested spacing within the block
  uint32_t first_surfel = 0;     ///< index of its first surfel in the model, see Scene::first_surfel
  uint32_t kind = 0;             ///< number in the table of kinds
};

/// All inputs for drawing one region.
struct RegionTask {
  const residency::SurfelBuffer* surfels = nullptr;
  kinds::KindTable kinds;
  std::vector<VisibleBlock> blocks;
  geometry::CameraFrame frame;
  Region region;                     ///< requested pixels
  Region drawn;                      ///< `region`, or `region` with a margin of neighbouring pixels
  layout::FrameConstants constants;  ///< of `drawn`
  Variant variant;
  const picture::PictureRequest* request = nullptr;
  DisplayOptions display;
  const ConstantTexels* colors = nullptr;  ///< color_table of `display`, if it is mapped
  size_t list_entries = 0;                 ///< the most entries of all tile lists together
  picture::DepthMap* depth = nullptr;      ///< with Variant::depth: of the picture; the region's surfaces are added
};

/// Milliseconds and counts of one region.
struct RegionStats {
  uint64_t splats = 0;
  double project_ms = 0;  ///< projection, culling, counting
  double bin_ms = 0;
  double splat_ms = 0;  ///< visibility, accumulation, normalisation, shading, eye-dome lighting
  double read_ms = 0;

  RegionStats& operator+=(const RegionStats& more);
};

/// Draws a region with the passes project, bin_offsets, bin and splat; then, if requested, silhouettes, supersample and
/// eye_dome. Reads the result into `pixels` (4 bytes or 4 floats per pixel, rows from the top): the pixels of `drawn`,
/// or with eye_dome those of `region`. None if the tile lists are too long: the region must be drawn in parts.
Result<std::optional<RegionStats>> draw_region(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                               const Preemption& preemption, std::span<std::byte> pixels);

/// Makes room for the layers of every pixel (shared/volume_layout.h), none of which there is yet.
void clear_layers(const Region& drawn, StorageBuffer& layers);

/// Makes room for the depths of the pixels, none of which there is yet.
void clear_fronts(const Region& drawn, SplatBuffers& buffers);

/// Draws the surfaces of a region for what is drawn between them: they are kept in `buffers.volume.layers`
/// (shaders/include/keep_layer.glsl). Eye-dome lighting and supersampled silhouettes are left out. `kinds`: those that
/// are drawn as surfaces. None if the tile lists are too long.
Result<std::optional<RegionStats>> draw_layers(RegionTask task, const PictureKinds& kinds, Programs& programs,
                                               SplatBuffers& buffers, const Preemption& preemption);

/// Reads the finished pixels, and enters their depths in the depth map if it is asked for. Returns the milliseconds
/// that it took. Fails on errors of OpenGL up to here.
Result<double> read_picture(const RegionTask& task, const SplatBuffers& buffers, std::span<std::byte> pixels);

}  // namespace surfcast::render
