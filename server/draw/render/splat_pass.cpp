#include "render/splat_pass.h"

#include "render/batched_dispatch.h"
#include "render/behind_pass.h"

namespace surfcast::render {
namespace {

size_t pixels_of_tiles(const RegionTask& task) {
  constexpr size_t kPixels = size_t{SURFCAST_TILE_WIDTH} * SURFCAST_TILE_HEIGHT;
  return kPixels * static_cast<size_t>(task.constants.tiles.z);
}

void clear_silhouettes(const RegionTask& task, bool long_lists, SplatBuffers& buffers) {
  const size_t pixels = pixels_of_tiles(task);
  buffers.silhouettes.reserve(sizeof(glm::uvec4) + (long_lists ? 2 : 1) * pixels * sizeof(glm::uvec2));
  constexpr GLuint kNone[4] = {};
  glNamedBufferSubData(buffers.silhouettes.name(), 0, sizeof kNone, kNone);
}

/// Draws a span of tiles, with and without large splats.
Status draw_span(const RegionTask& task, const TileSpan& span, bool large, const RegionPrograms& programs,
                 BatchSizer& sizer, SplatBuffers& buffers, const Preemption& preemption) {
  if (!span.together) return draw_tiles(task, span, *programs.lanes.splat, sizer, buffers, preemption);
  if (span.first == span.end) return {};
  Status status = draw_tiles(task, span, *programs.groups.splat, buffers.long_lists.splat, buffers, preemption);
  if (!status || !large) return status;
  return draw_tiles(task, span, *programs.groups.splat_large, buffers.long_lists.splat_large, buffers, preemption);
}

}  // namespace

bool has_long_lists(const layout::Counters& counters) {
  return counters.counts.w >= SURFCAST_LONG_LIST;
}

void bind_for_splatting(const RegionTask& task, const SplatBuffers& buffers) {
  bind_frame(buffers);
  buffers.next_tiles.bind(SURFCAST_BIND_NEXT_TILES);
  buffers.picture.bind(SURFCAST_BIND_PICTURE);
  if (task.variant.eye_dome) {
    buffers.light.bind(SURFCAST_BIND_LIGHT);
    buffers.depth.bind(SURFCAST_BIND_DEPTH);
  }
  if (task.variant.layered) buffers.volume.layers.bind(SURFCAST_BIND_LAYERS);
  buffers.splats.bind_for_reading(SURFCAST_UNIT_SPLATS);
  buffers.discs.bind_for_reading(SURFCAST_UNIT_DISCS);
  buffers.lists.bind_for_reading(SURFCAST_UNIT_LISTS);
  if (task.variant.colored && task.variant.lit) buffers.normals.bind_for_reading(SURFCAST_UNIT_NORMALS);
  if (buffers.reaches.texels() > 0) buffers.reaches.bind_for_reading(SURFCAST_UNIT_REACHES);
  if (buffers.unfinished.texels() > 0) {
    buffers.unfinished_count.bind(SURFCAST_BIND_UNFINISHED);
    buffers.unfinished.bind_for_writing(SURFCAST_UNIT_UNFINISHED);
    buffers.unfinished.bind_for_reading(SURFCAST_UNIT_UNFINISHED);
  }
  if (task.variant.keeps_fronts()) buffers.fronts.bind(SURFCAST_BIND_FRONTS);
  if (task.variant.shown_depths) buffers.shown_depths.bind(SURFCAST_BIND_SHOWN_DEPTHS);
  if (task.variant.silhouettes) buffers.silhouettes.bind(SURFCAST_BIND_SILHOUETTES);
}

Status draw_tiles(const RegionTask& task, const TileSpan& span, const gl::Program& program, BatchSizer& sizer,
                  SplatBuffers& buffers, const Preemption& preemption) {
  if (span.first == span.end) return {};
  const Groups groups{(span.end - span.first + span.tiles_per_group - 1) / span.tiles_per_group, {}};
  buffers.next_tiles.reserve(groups.count * sizeof(GLuint));
  buffers.next_tiles.clear();
  return dispatch_in_batches(groups, sizer, preemption, [&] {
    bind_for_splatting(task, buffers);
    glUseProgram(program.name());
    glUniform3ui(SURFCAST_UNIFORM_SPAN, span.first, span.end, span.tiles_per_group);
  });
}

Status splat(const RegionTask& task, const layout::Counters& counters, const RegionPrograms& programs,
             const KernelShape& shape, SplatBuffers& buffers, const Preemption& preemption) {
  const gl::DebugGroup group("splat");
  if (task.variant.eye_dome) {
    const size_t pixels = static_cast<size_t>(task.drawn.width) * static_cast<size_t>(task.drawn.height);
    buffers.light.reserve(pixels * sizeof(glm::vec4));
    buffers.depth.reserve(pixels * sizeof(glm::vec2));
  }
  if (task.variant.keeps_fronts()) buffers.fronts.reserve(pixels_of_tiles(task) * sizeof(float));
  if (task.variant.shown_depths) buffers.shown_depths.reserve(pixels_of_tiles(task) * sizeof(glm::vec2));
  if (task.variant.silhouettes) clear_silhouettes(task, has_long_lists(counters), buffers);
  reserve_unfinished(task, programs.lanes, buffers);
  const auto tiles = static_cast<uint32_t>(task.constants.tiles.z);
  const std::vector<TileSpan> spans = spans_of_tiles(counters, tiles, shape);
  for (size_t i = 0; i < spans.size(); ++i) {
    Status status =
        draw_span(task, spans[i], counters.counts.y > 0, programs, buffers.splat_batches.at(i), buffers, preemption);
    if (!status) return status;
    status =
        draw_behind(task, programs.lanes.behind, spans[i].tiles_per_group, buffers.behind_batches, buffers, preemption);
    if (!status) return status;
  }
  if (counters.counts.y == 0) return {};
  const TileSpan others{spans.front().end, tiles, static_cast<uint32_t>(shape.tiles_at_once)};
  return draw_tiles(task, others, *programs.lanes.splat_large, buffers.splat_large_batches, buffers, preemption);
}

}  // namespace surfcast::render
