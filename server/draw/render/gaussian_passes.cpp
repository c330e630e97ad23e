#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "base/preemption.h"
#include "gaussian/pack_gaussians.h"
#include "render/batched_dispatch.h"
#include "render/projection_work.h"
#include "render/region_passes.h"
#include "render/sorted_items.h"
#include "render/tile_lists.h"
#include "shared/gaussian_layout.h"

namespace surfcast::render {
namespace {

uint32_t texels_of_gaussian(uint32_t run) {
  return gaussian::texels_per_gaussian(static_cast<int>((run >> SURFCAST_RUN_DEGREE_SHIFT) & 7U));
}

Status project(const RegionTask& task, const ProjectionWork& work, const gl::Program& program, SplatBuffers& buffers,
               const Preemption& preemption) {
  const gl::DebugGroup group("project Gaussians");
  return dispatch_in_batches({work.chunks.size(), {}}, buffers.gaussians.project_batches, preemption, [&] {
    buffers.frame.bind_uniforms(SURFCAST_BIND_FRAME);
    bind_items(task, buffers);
    buffers.gaussians.records.bind_for_writing(SURFCAST_UNIT_SPLATS);
    buffers.gaussians.keys.bind_for_writing(SURFCAST_UNIT_BOUNDS);
    glUseProgram(program.name());
  });
}

/// Draws so many tiles, from an entry of their lists on. `near`: depth of the nearest centre that is drawn.
Status blend(const ListRound& round, const GaussianPrograms& programs, float near, SplatBuffers& buffers,
             const Preemption& preemption) {
  const Groups groups = groups_of_tiles(round.tiles, programs.lanes_of_tile, programs.lanes);
  return dispatch_in_batches(groups, buffers.gaussians.blend_batches, preemption, [&] {
    buffers.frame.bind_uniforms(SURFCAST_BIND_FRAME);
    buffers.gaussians.tiles.bind(SURFCAST_BIND_TILE_ORDER);
    buffers.light.bind(SURFCAST_BIND_LIGHT);
    buffers.picture.bind(SURFCAST_BIND_PICTURE);
    buffers.gaussians.records.bind_for_reading(SURFCAST_UNIT_SPLATS);
    buffers.gaussians.lists.bind_for_reading(SURFCAST_UNIT_LISTS);
    if (programs.layered) buffers.volume.layers.bind(SURFCAST_BIND_LAYERS);
    if (programs.needs_keys()) buffers.gaussians.keys.bind_for_reading(SURFCAST_UNIT_BOUNDS);
    if (programs.keeps_fronts) buffers.fronts.bind(SURFCAST_BIND_FRONTS);
    if (programs.keeps) buffers.gaussians.layers.bind(SURFCAST_BIND_KEPT);
    glUseProgram(programs.blend->name());
    glUniform2ui(SURFCAST_UNIFORM_SPAN, round.tiles, round.first);
    if (programs.has_near) glUniform1f(SURFCAST_UNIFORM_NEAR, near);
  });
}

/// Draws the tiles, those with long lists in several rounds.
Status blend_rounds(const RegionTask& task, const TileLists& lists, const GaussianPrograms& programs, float near,
                    SplatBuffers& buffers, const Preemption& preemption) {
  const gl::DebugGroup group("blend Gaussians");
  const bool several = lists.longer_than(programs.round) > 0;
  const size_t pixels = static_cast<size_t>(task.drawn.width) * static_cast<size_t>(task.drawn.height);
  buffers.light.reserve((several ? pixels : 1) * sizeof(glm::vec4));
  return draw_rounds(lists, programs.round,
                     [&](const ListRound& round) { return blend(round, programs, near, buffers, preemption); });
}

GaussianForm form_of(const RegionTask& task, const ProjectionWork& work) {
  if (task.variant.exact) return GaussianForm::kExact;
  const bool flat = std::ranges::any_of(
      work.chunks, [](const layout::Chunk& chunk) { return (chunk.run.z & SURFCAST_RUN_FLAT) != 0; });
  return flat ? GaussianForm::kFlat : GaussianForm::kTrained;
}

/// The lists of the tiles; none if they are too long.
std::optional<TileLists> list_gaussians(const RegionTask& task, size_t count, const TexelBuffer& keys) {
  const glm::uvec2 tiles(task.constants.tiles.x, task.constants.tiles.y);
  if (!task.variant.exact) return list_by_depth(read_keys(count, keys), tiles, task.list_entries);
  const ExactKeys exact = unpack_exact_keys(read_keys(count * SURFCAST_EXACT_GAUSSIAN_KEY, keys));
  std::optional<TileLists> lists = list_by_depth(exact.keys, tiles, task.list_entries);
  const auto rays_of_tile = [&](uint32_t tile) {
    const glm::dvec2 size(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);
    const glm::dvec2 corner =
        glm::dvec2(task.drawn.x, task.drawn.y) + size * glm::dvec2(tile % tiles.x, tile / tiles.x);
    const glm::dvec2 first(task.frame.ray(corner + 0.5));
    const glm::dvec2 last(task.frame.ray(corner + size - 0.5));
    return TileRays{glm::min(first, last), glm::max(first, last)};
  };
  if (lists) order_by_rays(exact.depths, rays_of_tile, *lists);
  return lists;
}

/// Volumes are blended in the same way in all regions of a picture.
bool draws_among_volumes(const RegionTask& task) {
  return task.among_gaussians && has_blocks(task, kinds::DrawnAs::kVolume);
}

Result<std::optional<RegionStats>> draw_gaussians(const RegionTask& task, const PassPlaces& places, Programs& programs,
                                                  SplatBuffers& buffers, const Preemption& preemption) {
  Variant variant = task.variant;
  variant.keeps = places.writes == Place::kCodes;
  variant.layered = places.reads == Place::kSurfaces;
  ProjectionWork work = plan_work(task, kinds_of(task, kinds::DrawnAs::kGaussians));
  const Result<GaussianPrograms> compiled = programs.gaussians(variant, form_of(task, work));
  if (!compiled) return fail(compiled);
  RegionStats stats;
  const WorkStopwatch project_watch(preemption);
  const uint32_t count = number_items(work, texels_of_gaussian);
  buffers.gaussians.records.reserve(size_t{compiled->record} * std::max(count, 1U), buffers.lazy);
  buffers.gaussians.keys.reserve(size_t{compiled->key} * std::max(count, 1U), buffers.lazy);
  upload_items(task, work, buffers);
  upload_uniforms(buffers.frame, task.constants);
  if (Status status = project(task, work, *compiled->project, buffers, preemption); !status) {
    return fail(status);
  }
  stats.project_ms = project_watch.milliseconds();

  const WorkStopwatch bin_watch(preemption);
  const std::optional<TileLists> lists = list_gaussians(task, count, buffers.gaussians.keys);
  if (!lists) return std::optional<RegionStats>();
  upload_lists(*lists, buffers.lazy, buffers.gaussians.tiles, buffers.gaussians.lists);
  stats.splats = lists->drawn;
  stats.bin_ms = bin_watch.milliseconds();

  const WorkStopwatch blend_watch(preemption);
  // BlockView::scale.x is the unit of the projection.
  const float near = work.blocks.empty() ? 0 : static_cast<float>(SURFCAST_TRAINED_NEAR) * work.blocks.front().scale.x;
  Status status = blend_rounds(task, *lists, *compiled, near, buffers, preemption);
  if (!status) return fail(status);
  stats.splat_ms = blend_watch.milliseconds();
  return std::optional(stats);
}

}  // namespace

const RegionPass kGaussianPass{.draws = kinds::DrawnAs::kGaussians,
                               .also_needed = draws_among_volumes,
                               .leaves = Place::kCodes,
                               .adds_to = Place::kSurfaces,
                               .draw = draw_gaussians};

}  // namespace surfcast::render
