#include "render/behind_pass.h"

#include "render/splat_pass.h"

namespace surfcast::render {

void reserve_unfinished(const RegionTask& task, const SplatPrograms& programs, SplatBuffers& buffers) {
  if (programs.behind == nullptr) return;
  constexpr size_t kTexels = 8;  // include/unfinished.glsl
  constexpr size_t kPixels = size_t{SURFCAST_TILE_WIDTH} * SURFCAST_TILE_HEIGHT;
  buffers.unfinished.reserve(kTexels * kPixels * static_cast<size_t>(task.constants.tiles.z), buffers.lazy);
  buffers.unfinished_count.reserve(sizeof(GLuint));
  buffers.unfinished_count.clear();
}

Status draw_behind(const RegionTask& task, const gl::Program* program, uint32_t per_group, BatchSizer& sizer,
                   SplatBuffers& buffers, const Preemption& preemption) {
  if (program == nullptr) return {};
  GLuint count = 0;
  glGetNamedBufferSubData(buffers.unfinished_count.name(), 0, sizeof count, &count);
  if (count == 0) return {};
  buffers.unfinished_count.clear();
  return draw_tiles(task, {0, count, per_group, false}, *program, sizer, buffers, preemption);
}

}  // namespace surfcast::render
