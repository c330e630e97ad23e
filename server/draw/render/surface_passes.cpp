#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "render/batched_dispatch.h"
#include "render/depth_slices.h"
#include "render/projection_work.h"
#include "render/region_passes.h"
#include "render/silhouette_passes.h"
#include "render/splat_pass.h"

namespace surfcast::render {
namespace {

/// The levels of depth of a region (shaders/include/depth_slices.glsl): as many in each slice.
glm::ivec4 slice_constants(const DepthSlices& slices) {
  constexpr int kLevels = SURFCAST_LEVELS / SURFCAST_SLICES;
  const float levels_per_bit = static_cast<float>(kLevels) / static_cast<float>(slices.step);
  return {slices.count, slices.second + slices.step - slices.step / kLevels, std::bit_cast<int32_t>(levels_per_bit), 0};
}

void upload_constants(const RegionTask& task, const DepthSlices& slices, SplatBuffers& buffers) {
  layout::FrameConstants constants = task.constants;
  constants.tiles.w = static_cast<int>(buffers.splat_capacity());
  constants.slices = slice_constants(slices);
  upload_uniforms(buffers.frame, constants);
}

/// Uploads the parameters of the display options that the picture uses.
void upload_display_options(const RegionTask& task, const ProjectionWork& work, SplatBuffers& buffers) {
  const DisplayOptions& display = task.display;
  if (needs_block_displays(display)) upload(buffers.block_displays, work.block_displays);
  if (display.clipped) upload(buffers.clips, work.clips.empty() ? std::vector<layout::ClipRange>(1) : work.clips);
  if (display.mapped() || display.hides_classes)
    upload_uniforms(buffers.display, display_constants(display, *task.request));
  if (display.through.by_class || display.through.ghosts)
    upload_uniforms(buffers.through, through_constants(*task.request));
}

void bind_display_options(const RegionTask& task, const SplatBuffers& buffers) {
  const DisplayOptions& display = task.display;
  if (needs_block_displays(display)) buffers.block_displays.bind(SURFCAST_BIND_BLOCK_DISPLAYS);
  if (display.clipped) buffers.clips.bind(SURFCAST_BIND_CLIPS);
  if (display.mapped() || display.hides_classes) buffers.display.bind_uniforms(SURFCAST_BIND_DISPLAY);
  if (display.through.by_class || display.through.ghosts) buffers.through.bind_uniforms(SURFCAST_BIND_THROUGH);
  if (display.mapped()) task.colors->bind(SURFCAST_UNIT_COLORS);
  if (display.attributes) task.surfels->bind_attributes(SURFCAST_UNIT_ATTRIBUTES);
}

void clear_counts(const RegionTask& task, const DepthSlices& slices, SplatBuffers& buffers) {
  const auto tiles = static_cast<size_t>(task.constants.tiles.z);
  buffers.counters.reserve(sizeof(layout::Counters));
  buffers.counters.clear();
  buffers.tile_count.reserve(tiles * (slices.count + 1) * sizeof(GLuint));
  buffers.tile_count.clear();
  buffers.tile_offset.reserve(tiles * sizeof(GLuint));
  buffers.tile_order.reserve(tiles * sizeof(GLuint));
}

void bind_for_projection(const RegionTask& task, const SplatBuffers& buffers) {
  bind_frame(buffers);
  bind_display_options(task, buffers);
  buffers.blocks.bind(SURFCAST_BIND_BLOCKS);
  buffers.chunks.bind(SURFCAST_BIND_CHUNKS);
  buffers.splats.bind_for_writing(SURFCAST_UNIT_SPLATS);
  buffers.discs.bind_for_writing(SURFCAST_UNIT_DISCS);
  buffers.bounds.bind_for_writing(SURFCAST_UNIT_BOUNDS);
  if (task.variant.colored && task.variant.lit) buffers.normals.bind_for_writing(SURFCAST_UNIT_NORMALS);
  task.surfels->bind(SURFCAST_UNIT_SURFELS);
  buffers.srgb.bind(SURFCAST_UNIT_SRGB);
}

void bind_for_counting(const SplatBuffers& buffers) {
  bind_frame(buffers);
  buffers.bounds.bind_for_reading(SURFCAST_UNIT_BOUNDS);
}

void bind_for_binning(const SplatBuffers& buffers) {
  bind_for_counting(buffers);
  buffers.lists.bind_for_writing(SURFCAST_UNIT_LISTS);
  if (buffers.reaches.texels() > 0) buffers.reaches.bind_for_writing(SURFCAST_UNIT_REACHES);
}

layout::Counters read_counters(const SplatBuffers& buffers) {
  layout::Counters counters;
  glGetNamedBufferSubData(buffers.counters.name(), 0, sizeof counters, &counters);
  return counters;
}

/// The most splats of a region. Each record has two texels, and a list entry has room for a number of so many bits.
size_t most_splats() {
  return std::min(residency::BlockMemory::device_limit() / 2, size_t{1} << SURFCAST_SLICE_SHIFT);
}

/// The initial capacity in splats. With lazily committed memory there is room for every surfel, so the projection is
/// never repeated for lack of room.
size_t first_capacity(const ProjectionWork& work, const SplatBuffers& buffers) {
  constexpr size_t kFirst = 1u << 18;
  if (!buffers.lazy) return kFirst;
  return std::clamp(std::bit_ceil(work.chunks.size() * SURFCAST_CHUNK), kFirst, most_splats());
}

/// Projects the visible blocks, one kind after another.
Status project_kinds(const RegionTask& task, const ProjectionWork& work, const SplatPrograms& variant,
                     SplatBuffers& buffers, const Preemption& preemption) {
  for (size_t i = 0; i < work.kinds.size(); ++i) {
    const Groups groups{work.kinds[i].count, {}, work.kinds[i].first};
    Status projected = dispatch_in_batches(groups, buffers.project_batches, preemption, [&] {
      bind_for_projection(task, buffers);
      glUseProgram(variant.project[i]->name());
    });
    if (!projected) return projected;
  }
  return {};
}

size_t ceil_divide(int total, int part) {
  return static_cast<size_t>((total + part - 1) / part);
}

Groups groups_of_lanes(size_t lanes) {
  return {(lanes + SURFCAST_CHUNK - 1) / SURFCAST_CHUNK, {}};
}

/// Lanes that bin the large splats.
size_t large_lanes(const RegionTask& task, const layout::Counters& counters) {
  return counters.counts.y * ceil_divide(task.constants.tiles.y, SURFCAST_BAND_ROWS);
}

Status count_large(const RegionTask& task, const layout::Counters& counters, const Programs& programs,
                   SplatBuffers& buffers, const Preemption& preemption) {
  return dispatch_in_batches(groups_of_lanes(large_lanes(task, counters)), buffers.count_large_batches, preemption,
                             [&] {
                               bind_for_counting(buffers);
                               glUseProgram(programs.count_large().name());
                             });
}

/// Sums up the tile counts.
Result<layout::Counters> sum_up(const RegionTask& task, const Programs& programs, SplatBuffers& buffers,
                                const Preemption& preemption) {
  const auto tiles = static_cast<size_t>(task.constants.tiles.z);
  const Status summed = dispatch_in_batches(groups_of_lanes(tiles), buffers.slice_batches, preemption, [&] {
    bind_frame(buffers);
    glUseProgram(programs.slices().name());
  });
  if (!summed) return fail(summed);
  bind_frame(buffers);
  glUseProgram(programs.bin_offsets().name());
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  return read_counters(buffers);
}

/// Projects the visible blocks and sums up the tile counts. Repeats this if the records did not fit.
Result<layout::Counters> project(const RegionTask& task, const ProjectionWork& work, Programs& programs,
                                 const SplatPrograms& variant, SplatBuffers& buffers, const Preemption& preemption) {
  const gl::DebugGroup group("project");
  const bool with_normals = task.variant.colored && task.variant.lit;
  buffers.reserve_splats(std::max(first_capacity(work, buffers), buffers.splat_capacity()), with_normals);
  upload(buffers.blocks, work.blocks);
  upload(buffers.chunks, work.chunks);
  upload_display_options(task, work, buffers);
  const bool culled = task.constants.flags.x != 0;
  // What is behind the front surface is blended by one walk over all of the list.
  const DepthSlices slices = task.variant.blends_behind
                                 ? DepthSlices{}
                                 : depth_slices(work.depths, culled, static_cast<size_t>(task.constants.tiles.z));
  while (true) {
    upload_constants(task, slices, buffers);
    clear_counts(task, slices, buffers);
    if (Status projected = project_kinds(task, work, variant, buffers, preemption); !projected) {
      return fail(projected);
    }
    const layout::Counters splats = read_counters(buffers);
    const size_t needed = size_t{splats.counts.x} + splats.counts.y;
    if (needed > buffers.splat_capacity()) {
      // The pool is limited so that the records of all its surfels fit.
      buffers.reserve_splats(std::min(needed + needed / 4, most_splats()), with_normals);
      continue;
    }
    Status counted = count_large(task, splats, programs, buffers, preemption);
    if (!counted) return fail(counted);
    return sum_up(task, programs, buffers, preemption);
  }
}

Status bin(const RegionTask& task, const layout::Counters& counters, const Programs& programs, SplatBuffers& buffers,
           const Preemption& preemption) {
  const gl::DebugGroup group("bin");
  const size_t entries = counters.counts.z;
  const size_t room = std::clamp<size_t>(entries + entries / 4, 1, std::max(task.list_entries, entries));
  buffers.lists.reserve(room, buffers.lazy);
  if (programs.selects(task.variant)) buffers.reaches.reserve(room, buffers.lazy);
  const Groups groups = groups_of_lanes(counters.counts.x + large_lanes(task, counters));
  return dispatch_in_batches(groups, buffers.bin_batches, preemption, [&] {
    bind_for_binning(buffers);
    glUseProgram(programs.bin(task.variant).name());
  });
}

/// Compiles the programs for long lists if there are any.
Status add_long_list_programs(const RegionTask& task, const PictureKinds& kinds, const layout::Counters& counters,
                              Programs& programs, RegionPrograms& region) {
  if (!has_long_lists(counters)) return {};
  Result<LongListPrograms> groups = programs.long_lists(task.variant, kinds, counters.counts.w);
  if (!groups) return fail(groups);
  region.groups = *groups;
  return {};
}

/// Converts the light and depth of `drawn` to the requested pixels.
void shade_by_depth(const RegionTask& task, const gl::Program& program, SplatBuffers& buffers) {
  const gl::DebugGroup group("eye_dome");
  const picture::EyeDome& eye_dome = task.request->eye_dome;
  const layout::EyeDomeConstants constants{
      glm::vec4(eye_dome.strength, eye_dome.radius, 0, 0),
      glm::ivec4(task.region.x - task.drawn.x, task.region.y - task.drawn.y, task.region.width, task.region.height)};
  upload_uniforms(buffers.eye_dome, constants);
  buffers.eye_dome.bind_uniforms(SURFCAST_BIND_EYE_DOME);
  glUseProgram(program.name());
  const Groups groups = all_pixels(task.region.width, task.region.height);
  glDispatchCompute(static_cast<GLuint>(*groups.width), static_cast<GLuint>(groups.count), 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

/// Draws the surfaces of a region as its variant says. None if the tile lists are too long.
Result<std::optional<RegionStats>> draw_variant(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                                const Preemption& preemption) {
  const PictureKinds kinds = kinds_of(task, kinds::DrawnAs::kSurface);
  Result<SplatPrograms> variant = programs.variant(task.variant, kinds);
  if (!variant) return fail(variant);
  RegionPrograms region{std::move(*variant), {}};

  RegionStats stats;
  const WorkStopwatch project_watch(preemption);
  const Result<layout::Counters> counters =
      project(task, plan_work(task, kinds), programs, region.lanes, buffers, preemption);
  if (!counters) return fail(counters);
  if (counters->counts.z > task.list_entries) return std::optional<RegionStats>();
  if (Status status = add_long_list_programs(task, kinds, *counters, programs, region); !status) {
    return fail(status);
  }
  stats.splats = uint64_t{counters->counts.x} + counters->counts.y;
  stats.project_ms = project_watch.milliseconds();

  const WorkStopwatch bin_watch(preemption);
  if (Status status = bin(task, *counters, programs, buffers, preemption); !status) return fail(status);
  stats.bin_ms = bin_watch.milliseconds();

  const WorkStopwatch splat_watch(preemption);
  if (Status status = splat(task, *counters, region, programs.shape(), buffers, preemption); !status) {
    return fail(status);
  }
  if (task.variant.silhouettes) {
    Status status = supersample_silhouettes(task, *counters, region, programs.shape(), buffers, preemption);
    if (!status) return fail(status);
  }
  if (task.variant.eye_dome && !task.variant.layered) {
    shade_by_depth(task, *region.lanes.eye_dome, buffers);
    glFinish();
  }
  stats.splat_ms = splat_watch.milliseconds();
  return std::optional(stats);
}

/// The variant that keeps surfaces for what is drawn between them.
Variant layered(Variant variant) {
  variant.layered = variant.eye_dome = true;
  variant.silhouettes = false;
  variant.depth = false;  // that of the pixels is known when all is drawn
  // The depth of all that is behind the front surface as one would not be known.
  variant.blends_behind = false;
  return variant;
}

Result<std::optional<RegionStats>> draw_surfaces(const RegionTask& task, const PassPlaces& places, Programs& programs,
                                                 SplatBuffers& buffers, const Preemption& preemption) {
  if (places.writes == Place::kPicture) return draw_variant(task, programs, buffers, preemption);
  RegionTask kept = task;
  kept.variant = layered(task.variant);
  return draw_variant(kept, programs, buffers, preemption);
}

}  // namespace

const RegionPass kSurfacePass{
    .draws = kinds::DrawnAs::kSurface, .leaves = Place::kSurfaces, .covers = true, .draw = draw_surfaces};

}  // namespace surfcast::render
