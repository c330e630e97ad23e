#include "render/volume_passes.h"

#include <algorithm>

#include "base/contract.h"
#include "render/batched_dispatch.h"

namespace surfcast::render {
namespace {

void upload_plan(const RegionTask& task, const VolumePlan& plan, SplatBuffers& buffers) {
  upload_uniforms(buffers.frame, task.constants);
  upload_uniforms(buffers.volume.constants, plan.constants);
  upload(buffers.volume.clips, plan.clips);
  buffers.volume.bricks.upload(plan.bricks);
  buffers.volume.cells.upload(plan.cells);
  buffers.volume.pages.upload(plan.pages);
  buffers.volume.transfer.upload(plan.transfer);
  const size_t pixels = static_cast<size_t>(plan.constants.light.z) * static_cast<size_t>(plan.constants.light.w);
  buffers.volume.light.reserve(pixels * sizeof(glm::vec4));
  buffers.volume.rows.reserve(pixels * sizeof(glm::vec4));
  if (task.variant.layered) buffers.volume.surface_light.reserve(pixels * sizeof(glm::vec4));
}

void bind(const RegionTask& task, const SplatBuffers& buffers, const gl::Program& program) {
  buffers.frame.bind_uniforms(SURFCAST_BIND_FRAME);
  buffers.volume.constants.bind_uniforms(SURFCAST_BIND_VOLUME);
  buffers.volume.bricks.bind(SURFCAST_UNIT_BRICKS);
  buffers.volume.clips.bind(SURFCAST_BIND_VOLUME_CLIPS);
  buffers.volume.light.bind(SURFCAST_BIND_VOLUME_LIGHT);
  buffers.volume.rows.bind(SURFCAST_BIND_VOLUME_ROWS);
  if (task.variant.layered) {
    buffers.volume.layers.bind(SURFCAST_BIND_LAYERS);
    buffers.volume.surface_light.bind(SURFCAST_BIND_SURFACE_LIGHT);
  }
  buffers.picture.bind(SURFCAST_BIND_PICTURE);
  buffers.volume.cells.bind(SURFCAST_UNIT_CELLS);
  buffers.volume.pages.bind(SURFCAST_UNIT_PAGES);
  buffers.volume.transfer.bind(SURFCAST_UNIT_TRANSFER);
  task.surfels->bind(SURFCAST_UNIT_SURFELS);
  glUseProgram(program.name());
}

}  // namespace

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

Status draw_volumes(const RegionTask& task, const Region& written, double depth_unit,
                    std::span<const VisibleBrick> bricks, Programs& programs, SplatBuffers& buffers,
                    const Preemption& preemption) {
  const gl::DebugGroup group("volumes");
  Result<VolumePrograms> compiled = programs.volumes(task.variant);
  if (!compiled) return fail(std::move(compiled.error()));
  VolumePlan plan = plan_volume(bricks, task.display.volumes, task.frame, written);
  plan.constants.transfer.w = static_cast<float>(depth_unit);
  upload_plan(task, plan, buffers);
  const auto dispatch = [&](const gl::Program* program, int width, int height, BatchSizer& sizer) {
    return dispatch_in_batches(all_pixels(width, height), sizer, preemption, [&] { bind(task, buffers, *program); });
  };
  const glm::ivec4 light = plan.constants.light;
  Status status = dispatch(compiled->draw, light.z, light.w, buffers.volume.draw_batches);
  if (status) status = dispatch(compiled->filter_rows, written.width, light.w, buffers.volume.row_batches);
  if (status) status = dispatch(compiled->filter_columns, written.width, written.height, buffers.volume.column_batches);
  return status;
}

}  // namespace surfcast::render
