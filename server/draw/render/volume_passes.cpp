#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/contract.h"
#include "render/batched_dispatch.h"
#include "render/join_plans.h"
#include "render/projection_work.h"
#include "render/region_passes.h"
#include "render/volume_plan.h"

namespace surfcast::render {
namespace {

void upload_plan(const RegionTask& task, const JoinedPlan& joined, SplatBuffers& buffers) {
  const VolumePlan& plan = joined.tables;
  std::vector<layout::VolumeConstants> constants = joined.constants;
  constants.resize(room_for_volumes(constants.size()));
  upload_uniforms(buffers.frame, task.constants);
  upload(buffers.volume.constants, constants);
  upload(buffers.volume.clips, plan.clips);
  buffers.volume.bricks.upload(plan.bricks);
  buffers.volume.cells.upload(plan.cells);
  buffers.volume.seen.upload(plan.seen);
  buffers.volume.pages.upload(plan.pages);
  buffers.volume.transfer.upload(plan.transfer);
  if (task.variant.volume_surfaces) {
    std::vector<layout::VolumeSurfaces> surfaces = joined.surfaces;
    surfaces.resize(constants.size());
    upload(buffers.volume.surfaces, surfaces);
    buffers.volume.ramp.upload(plan.ramp);
  }
  const size_t pixels = static_cast<size_t>(plan.constants.light.z) * static_cast<size_t>(plan.constants.light.w);
  buffers.volume.light.reserve(pixels);
  buffers.volume.rows.reserve(pixels);
  if (task.variant.layered) buffers.volume.surface_light.reserve(pixels * sizeof(glm::vec4));
}

void bind(const RegionTask& task, const SplatBuffers& buffers, const gl::Program& program) {
  buffers.frame.bind_uniforms(SURFCAST_BIND_FRAME);
  buffers.volume.constants.bind_uniforms(SURFCAST_BIND_VOLUME);
  buffers.volume.bricks.bind(SURFCAST_UNIT_BRICKS);
  buffers.volume.clips.bind(SURFCAST_BIND_VOLUME_CLIPS);
  buffers.volume.light.bind(SURFCAST_BIND_VOLUME_LIGHT);
  buffers.volume.light.bind_texels(SURFCAST_UNIT_VOLUME_LIGHT);
  buffers.volume.rows.bind(SURFCAST_BIND_VOLUME_ROWS);
  buffers.volume.rows.bind_texels(SURFCAST_UNIT_VOLUME_ROWS);
  if (task.variant.layered) {
    (task.variant.codes ? buffers.gaussians.layers : buffers.volume.layers).bind(SURFCAST_BIND_LAYERS);
    buffers.volume.surface_light.bind(SURFCAST_BIND_SURFACE_LIGHT);
  }
  if (task.variant.depth) buffers.fronts.bind(SURFCAST_BIND_FRONTS);
  if (task.variant.volume_surfaces) {
    buffers.volume.surfaces.bind_uniforms(SURFCAST_BIND_VOLUME_SURFACES);
    buffers.volume.ramp.bind(SURFCAST_UNIT_RAMP);
  }
  buffers.picture.bind(SURFCAST_BIND_PICTURE);
  buffers.volume.cells.bind(SURFCAST_UNIT_CELLS);
  buffers.volume.seen.bind(SURFCAST_UNIT_SEEN);
  buffers.volume.pages.bind(SURFCAST_UNIT_PAGES);
  buffers.volume.transfer.bind(SURFCAST_UNIT_TRANSFER);
  task.surfels->bind(SURFCAST_UNIT_SURFELS);
  glUseProgram(program.name());
}

/// The plans of all volumes of a region. `depth_unit`: of the depths of surfaces (Variant::layered), world units.
JoinedPlan plan_volumes(const RegionTask& task, const Region& written, double depth_unit,
                        std::span<const VisibleBrick> bricks) {
  std::vector<VolumePlan> plans;
  for (const std::vector<VisibleBrick>& own : by_volume(bricks)) {
    plans.push_back(plan_volume(own, task.display.volumes, task.frame, written));
    plans.back().constants.transfer.w = static_cast<float>(depth_unit);
  }
  return join_plans(std::move(plans));
}

/// Fails if the device has no room for the constants of so many volumes.
Status check_number(size_t volumes) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &most);
  constexpr size_t kLargest = std::max(sizeof(layout::VolumeConstants), sizeof(layout::VolumeSurfaces));
  if (room_for_volumes(volumes) * kLargest <= static_cast<size_t>(most)) return {};
  return fail(ErrorKind::kLimit, "more volumes in view than the device can draw: " + std::to_string(volumes));
}

std::vector<VisibleBrick> bricks_of(const RegionTask& task) {
  std::vector<VisibleBrick> bricks;
  for (const VisibleBlock& block : task.blocks) {
    if (task.kinds[block.kind]->drawn_as() != kinds::DrawnAs::kVolume) continue;
    const auto* header = dynamic_cast<const kinds::BrickBlock*>(block.resident->header.get());
    SURFCAST_EXPECTS(header != nullptr);
    bricks.push_back({header, block.resident->pages});
  }
  return bricks;
}

/// Draws the volumes of a region into the pixels of `written`, as its variant says.
Status draw_rays(const RegionTask& task, const Region& written, Programs& programs, SplatBuffers& buffers,
                 const Preemption& preemption) {
  const gl::DebugGroup group("volumes");
  const JoinedPlan plan = plan_volumes(task, written, std::ldexp(1.0, -drawing_unit(task)), bricks_of(task));
  if (Status status = check_number(plan.constants.size()); !status) return status;
  Result<VolumePrograms> compiled = programs.volumes(task.variant, room_for_volumes(plan.constants.size()));
  if (!compiled) return fail(compiled);
  upload_plan(task, plan, buffers);
  const auto dispatch = [&](const gl::Program* program, int width, int height, BatchSizer& sizer) {
    return dispatch_in_batches(all_pixels(width, height), sizer, preemption, [&] { bind(task, buffers, *program); });
  };
  const glm::ivec4 light = plan.tables.constants.light;
  Status status = dispatch(compiled->draw, light.z, light.w, buffers.volume.draw_batches);
  if (status) status = dispatch(compiled->filter_rows, written.width, light.w, buffers.volume.row_batches);
  if (status) status = dispatch(compiled->filter_columns, written.width, written.height, buffers.volume.column_batches);
  return status;
}

Result<std::optional<RegionStats>> draw_volumes(const RegionTask& task, const PassPlaces& places, Programs& programs,
                                                SplatBuffers& buffers, const Preemption& preemption) {
  RegionTask between = task;
  between.variant.layered = places.reads != Place::kNowhere;
  between.variant.codes = places.reads == Place::kCodes;
  RegionStats stats;
  const WorkStopwatch watch(preemption);
  const Region& written = task.variant.eye_dome ? task.region : task.drawn;
  if (Status status = draw_rays(between, written, programs, buffers, preemption); !status) {
    return fail(status);
  }
  stats.splat_ms = watch.milliseconds();
  return std::optional(stats);
}

}  // namespace

const RegionPass kVolumePass{.draws = kinds::DrawnAs::kVolume, .draw = draw_volumes};

}  // namespace surfcast::render
