#include "render/region_passes.h"

#include <algorithm>

#include "base/stopwatch.h"

namespace surfcast {
namespace {

/// Work of one arena: a dispatch each, since buffers are bound per arena.
struct ArenaWork {
  std::vector<layout::BlockView> blocks;
  std::vector<layout::Chunk> chunks;
};

std::vector<ArenaWork> plan_work(const RegionTask& task) {
  std::vector<ArenaWork> work(task.model->arenas().size());
  for (const uint32_t index : task.visible_blocks) {
    const ResidentBlock& block = task.model->blocks()[index];
    ArenaWork& arena = work[block.arena];
    const auto view = static_cast<uint32_t>(arena.blocks.size());
    // Relative to the eye in double precision: single precision never sees world coordinates.
    arena.blocks.push_back(
        {glm::vec4(glm::vec3(task.frame.to_camera(block.origin)), static_cast<float>(block.radius_unit))});
    for (uint32_t first = 0; first < block.surfels; first += SURFCAST_CHUNK) {
      const uint32_t count = std::min<uint32_t>(SURFCAST_CHUNK, block.surfels - first);
      arena.chunks.push_back({glm::uvec4(view, block.first + first, count, 0)});
    }
  }
  return work;
}

template <typename T>
void upload(StorageBuffer& buffer, const std::vector<T>& values) {
  buffer.reserve(values.size() * sizeof(T));
  glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data());
}

void upload_constants(const RegionTask& task, bool thinned, SplatBuffers& buffers) {
  layout::FrameConstants constants = task.constants;
  constants.tiles.w = static_cast<int>(buffers.splat_capacity());
  constants.flags.z = thinned ? 1 : 0;
  buffers.frame.reserve(sizeof constants);
  glNamedBufferSubData(buffers.frame.name(), 0, sizeof constants, &constants);
  glBindBufferBase(GL_UNIFORM_BUFFER, SURFCAST_BIND_FRAME, buffers.frame.name());
}

void clear_counts(const RegionTask& task, SplatBuffers& buffers) {
  const size_t lists = 2 * static_cast<size_t>(task.constants.tiles.z);
  buffers.counters.reserve(sizeof(layout::Counters));
  buffers.counters.clear();
  buffers.tile_count.reserve(lists * 4);
  buffers.tile_count.clear();
  buffers.tile_offset.reserve(lists * 4);
  buffers.tile_crowd.reserve(lists * 2);
}

void bind_for_projection(const RegionTask& task, const SplatBuffers& buffers) {
  buffers.counters.bind(SURFCAST_BIND_COUNTERS);
  buffers.tile_count.bind(SURFCAST_BIND_TILE_COUNT);
  buffers.tile_offset.bind(SURFCAST_BIND_TILE_OFFSET);
  buffers.tile_crowd.bind(SURFCAST_BIND_TILE_CROWD);
  buffers.splats.bind_for_writing(SURFCAST_UNIT_SPLATS);
  buffers.discs.bind_for_writing(SURFCAST_UNIT_DISCS);
  buffers.bounds.bind_for_writing(SURFCAST_UNIT_BOUNDS);
  if (task.variant.colored && task.variant.lit) buffers.normals.bind_for_writing(SURFCAST_UNIT_NORMALS);
}

void dispatch_arena(const Arena& arena, const ArenaWork& work, SplatBuffers& buffers) {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFCAST_BIND_GEOMETRY, arena.geometry.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFCAST_BIND_SIZE, arena.size_and_weight.name());
  if (arena.colors) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFCAST_BIND_COLOR, arena.colors.name());
  upload(buffers.blocks, work.blocks);
  upload(buffers.chunks, work.chunks);
  buffers.blocks.bind(SURFCAST_BIND_BLOCKS);
  buffers.chunks.bind(SURFCAST_BIND_CHUNKS);
  constexpr size_t kMaxGroups = 65535;  // what GL promises along x: far above one arena's chunks
  static_assert((size_t{4} << 20) / SURFCAST_CHUNK < kMaxGroups);
  glDispatchCompute(static_cast<GLuint>(work.chunks.size()), 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

layout::Counters read_counters(const SplatBuffers& buffers) {
  layout::Counters counters;
  glGetNamedBufferSubData(buffers.counters.name(), 0, sizeof counters, &counters);
  return counters;
}

/// Projects all visible surfels and sums up the tile counts; again if the records did not fit, or if a tile is so
/// crowded that its splats are to be thinned out.
layout::Counters project(const RegionTask& task, const std::vector<ArenaWork>& work, Programs& programs,
                         const SplatPrograms& variant, SplatBuffers& buffers) {
  const gl::DebugGroup group("project");
  constexpr size_t kFirstCapacity = 1u << 18;
  const bool with_normals = task.variant.colored && task.variant.lit;
  buffers.reserve_splats(std::max(kFirstCapacity, buffers.splat_capacity()), with_normals);
  bool thinned = false;
  while (true) {
    upload_constants(task, thinned, buffers);
    clear_counts(task, buffers);
    bind_for_projection(task, buffers);
    glUseProgram(variant.project.name());
    for (size_t i = 0; i < work.size(); ++i) {
      if (!work[i].chunks.empty()) dispatch_arena(task.model->arenas()[i], work[i], buffers);
    }
    glUseProgram(programs.bin_offsets().name());
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    const layout::Counters counters = read_counters(buffers);
    const size_t needed = size_t{counters.counts.x} + counters.counts.y;
    const bool fits = needed <= buffers.splat_capacity();
    const bool crowded = counters.counts.w > SURFCAST_CROWD && !thinned;
    if (fits && !crowded) return counters;
    if (fits) {
      thinned = true;
    } else {
      buffers.reserve_splats(needed + needed / 4, with_normals);
    }
  }
}

void bin(const layout::Counters& counters, Programs& programs, SplatBuffers& buffers) {
  const gl::DebugGroup group("bin");
  buffers.lists.reserve(std::max<size_t>(counters.counts.z + counters.counts.z / 4, 1));
  buffers.bounds.bind_for_reading(SURFCAST_UNIT_BOUNDS);
  buffers.lists.bind_for_writing(SURFCAST_UNIT_LISTS);
  glUseProgram(programs.bin().name());
  const uint32_t splats = counters.counts.x + counters.counts.y;
  glDispatchCompute((splats + SURFCAST_CHUNK - 1) / SURFCAST_CHUNK, 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void splat(const RegionTask& task, const layout::Counters& counters, const SplatPrograms& variant,
           SplatBuffers& buffers, size_t picture_bytes) {
  const gl::DebugGroup group("splat");
  buffers.picture.reserve(picture_bytes);
  buffers.picture.bind(SURFCAST_BIND_PICTURE);
  buffers.splats.bind_for_reading(SURFCAST_UNIT_SPLATS);
  buffers.discs.bind_for_reading(SURFCAST_UNIT_DISCS);
  buffers.lists.bind_for_reading(SURFCAST_UNIT_LISTS);
  if (task.variant.colored && task.variant.lit) buffers.normals.bind_for_reading(SURFCAST_UNIT_NORMALS);
  const auto dispatch = [&task](const gl::Program& program) {
    glUseProgram(program.name());
    glDispatchCompute(static_cast<GLuint>(task.constants.tiles.x), static_cast<GLuint>(task.constants.tiles.y), 1);
  };
  dispatch(variant.splat);
  if (counters.counts.y > 0) dispatch(variant.splat_large);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

Status check(const std::atomic<bool>& cancelled) {
  if (cancelled.load(std::memory_order_relaxed)) return fail(ErrorKind::kCancelled, "cancelled");
  return {};
}

}  // namespace

Result<RegionStats> draw_region(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                const std::atomic<bool>& cancelled, std::span<std::byte> pixels) {
  Result<const SplatPrograms*> variant = programs.variant(task.variant);
  if (!variant) return fail(std::move(variant.error()));

  RegionStats stats;
  Stopwatch project_watch;
  const layout::Counters counters = project(task, plan_work(task), programs, **variant, buffers);
  stats.splats = uint64_t{counters.counts.x} + counters.counts.y;
  stats.project_ms = project_watch.milliseconds();
  if (Status status = check(cancelled); !status) return fail(std::move(status.error()));

  Stopwatch bin_watch;
  bin(counters, programs, buffers);
  glFinish();
  stats.bin_ms = bin_watch.milliseconds();
  if (Status status = check(cancelled); !status) return fail(std::move(status.error()));

  Stopwatch splat_watch;
  splat(task, counters, **variant, buffers, pixels.size());
  glFinish();
  stats.splat_ms = splat_watch.milliseconds();

  Stopwatch read_watch;
  glGetNamedBufferSubData(buffers.picture.name(), 0, static_cast<GLsizeiptr>(pixels.size()), pixels.data());
  stats.read_ms = read_watch.milliseconds();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return fail(error == GL_OUT_OF_MEMORY ? ErrorKind::kLimit : ErrorKind::kInternal,
                error == GL_OUT_OF_MEMORY ? "the GPU is out of memory for this picture"
                                          : "OpenGL error " + std::to_string(error));
  }
  return stats;
}

}  // namespace surfcast
