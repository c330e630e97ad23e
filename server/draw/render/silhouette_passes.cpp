#include "render/silhouette_passes.h"

#include "render/batched_dispatch.h"
#include "render/behind_pass.h"
#include "shared/kernel.h"

namespace surfcast::render {
namespace {

/// Numbers of pixels at silhouettes, as in include/silhouette_list.glsl.
glm::uvec4 read_silhouette_counts(const SplatBuffers& buffers) {
  glm::uvec4 counts{0};
  glGetNamedBufferSubData(buffers.silhouettes.name(), 0, sizeof counts, &counts);
  return counts;
}

/// Runs a pass of the silhouettes over the tiles or parts from `first` to `end`.
Status dispatch_silhouettes(const RegionTask& task, const gl::Program* program, glm::uvec2 range, uint32_t lanes,
                            BatchSizer& sizer, SplatBuffers& buffers, const Preemption& preemption) {
  if (range.x == range.y) return {};
  const Groups groups{(range.y - range.x + lanes - 1) / lanes, {}};
  return dispatch_in_batches(groups, sizer, preemption, [&] {
    bind_for_splatting(task, buffers);
    glUseProgram(program->name());
    glUniform3ui(SURFCAST_UNIFORM_SPAN, range.x, range.y, 0);
  });
}

/// Finds the pixels at silhouettes in a span of tiles. Draws those of tiles without large splats and long lists again.
Status supersample_span(const RegionTask& task, const TileSpan& span, const SplatPrograms& programs,
                        const KernelShape& shape, SplatBuffers& buffers, const Preemption& preemption) {
  const auto lanes = static_cast<uint32_t>(shape.silhouette_lanes);
  const uint32_t done = read_silhouette_counts(buffers).x;
  Status status = dispatch_silhouettes(task, programs.silhouettes, {span.first, span.end}, lanes, buffers.find_batches,
                                       buffers, preemption);
  if (!status) return status;
  status = dispatch_silhouettes(task, programs.supersample, {done, read_silhouette_counts(buffers).x}, lanes,
                                buffers.supersample_batches, buffers, preemption);
  if (!status) return status;
  return draw_behind(task, programs.behind_samples, span.tiles_per_group, buffers.behind_samples_batches, buffers,
                     preemption);
}

/// The spans whose silhouettes are drawn together: of tiles with splats. Without columns that are handed over all tiles
/// are alike.
std::vector<TileSpan> spans_of_silhouettes(const layout::Counters& counters, const KernelShape& shape) {
  const uint32_t tiles = counters.lengths[0][0];  // with at least one entry
  if (!shape.whole_tiles) return {{0, tiles, 1, false}};
  return spans_of_tiles(counters, tiles, shape);
}

}  // namespace

Status supersample_silhouettes(const RegionTask& task, const layout::Counters& counters, const RegionPrograms& programs,
                               const KernelShape& shape, SplatBuffers& buffers, const Preemption& preemption) {
  const gl::DebugGroup group("silhouettes");
  for (const TileSpan& span : spans_of_silhouettes(counters, shape)) {
    Status status = supersample_span(task, span, programs.lanes, shape, buffers, preemption);
    if (!status) return status;
  }
  const glm::uvec4 counts = read_silhouette_counts(buffers);
  const auto draw = [&](const gl::Program* program, uint32_t count, int lanes, BatchSizer& sizer) {
    return dispatch_silhouettes(task, program, {0, count}, static_cast<uint32_t>(lanes), sizer, buffers, preemption);
  };
  LongListBatches& sizers = buffers.long_lists;
  Status status = draw(programs.lanes.supersample_large, counts.y,
                       shape.silhouette_lanes / programs.lanes.lanes_of_large_pixel, buffers.supersample_large_batches);
  if (status) status = draw(programs.groups.supersample, counts.z, 1, sizers.supersample);
  if (status) status = draw(programs.groups.supersample_large, counts.w, 1, sizers.supersample_large);
  return status;
}

}  // namespace surfcast::render
