#include <algorithm>
#include <cmath>
#include <utility>

#include "base/preemption.h"
#include "render/batched_dispatch.h"
#include "render/glyph_plan.h"
#include "render/projection_work.h"
#include "render/region_passes.h"
#include "render/sorted_items.h"
#include "render/tile_lists.h"
#include "shared/ellipsoid_layout.h"

namespace surfcast::render {
namespace {

/// The work of a region of ellipsoids.
struct EllipsoidWork {
  ProjectionWork projection;
  GlyphPlan plan;
  GlyphLights lights;
  Region samples;                           ///< the pixels whose samples are drawn: those that the prefilter reaches
  layout::FrameConstants sample_constants;  ///< of these
  uint32_t count = 0;                       ///< places of records
  EllipsoidTarget target = EllipsoidTarget::kPicture;
};

uint32_t texels_of_ellipsoid(uint32_t run) {
  return (run >> SURFCAST_RUN_ELLIPSOID_SHIFT) & SURFCAST_RUN_ELLIPSOID_TEXELS;
}

EllipsoidWork plan(const RegionTask& task, EllipsoidTarget target) {
  EllipsoidWork work;
  work.target = target;
  work.projection = plan_work(task, kinds_of(task, kinds::DrawnAs::kGlyphs));
  work.plan = plan_glyphs(task, drawing_unit(task));
  work.lights = lights_of(*task.request);
  constexpr int kReach = SURFCAST_GLYPH_REACH;
  work.samples = {task.drawn.x - kReach, task.drawn.y - kReach, task.drawn.width + 2 * kReach,
                  task.drawn.height + 2 * kReach};
  work.sample_constants = frame_constants(task.frame, work.samples, *task.request, {});
  work.count = number_items(work.projection, texels_of_ellipsoid);
  return work;
}

size_t pixels_of(const Region& region) {
  return static_cast<size_t>(region.width) * static_cast<size_t>(region.height);
}

void upload_work(const RegionTask& task, const EllipsoidWork& work, SplatBuffers& buffers) {
  upload_items(task, work.projection, buffers);
  upload_uniforms(buffers.frame, task.constants);
  upload_uniforms(buffers.ellipsoids.frame, work.sample_constants);
  upload(buffers.ellipsoids.views, work.plan.views);
  upload(buffers.ellipsoids.ranges, work.plan.ranges);
  upload_uniforms(buffers.ellipsoids.lighting, work.lights.lighting);
  upload(buffers.ellipsoids.lights, work.lights.lights);
}

void reserve(const EllipsoidWork& work, const EllipsoidPrograms& programs, SplatBuffers& buffers) {
  EllipsoidBuffers& own = buffers.ellipsoids;
  const size_t samples = pixels_of(work.samples) * programs.samples;
  const size_t shade = work.target == EllipsoidTarget::kPicture ? sizeof(glm::uvec2) : sizeof(glm::uvec4);
  own.records.reserve(size_t{programs.record} * std::max(work.count, 1U), buffers.lazy);
  own.keys.reserve(std::max(work.count, 1U), buffers.lazy);
  own.ids.reserve(samples * sizeof(GLuint));
  own.shades.reserve(samples * shade);
  own.rows.reserve(samples * shade);
}

Status project(const RegionTask& task, const EllipsoidWork& work, const gl::Program& program, SplatBuffers& buffers,
               const Preemption& preemption) {
  const gl::DebugGroup group("project ellipsoids");
  return dispatch_in_batches({work.projection.chunks.size(), {}}, buffers.ellipsoids.project_batches, preemption, [&] {
    buffers.ellipsoids.frame.bind_uniforms(SURFCAST_BIND_FRAME);
    bind_items(task, buffers);
    buffers.ellipsoids.views.bind(SURFCAST_BIND_GLYPH_VIEWS);
    buffers.ellipsoids.ranges.bind(SURFCAST_BIND_GLYPH_THRESHOLDS);
    if (work.plan.colored) task.colors->bind(SURFCAST_UNIT_COLORS);
    buffers.ellipsoids.records.bind_for_writing(SURFCAST_UNIT_SPLATS);
    buffers.ellipsoids.keys.bind_for_writing(SURFCAST_UNIT_BOUNDS);
    glUseProgram(program.name());
  });
}

std::optional<TileLists> list_ellipsoids(const RegionTask& task, const EllipsoidWork& work,
                                         const SplatBuffers& buffers) {
  const glm::ivec4 tiles = work.sample_constants.tiles;
  return list_by_depth(read_keys(work.count, buffers.ellipsoids.keys), glm::uvec2(tiles.x, tiles.y), task.list_entries);
}

/// The nearest ellipsoids of so many tiles, from an entry of their lists on.
Status find_nearest(const ListRound& round, const EllipsoidPrograms& programs, SplatBuffers& buffers,
                    const Preemption& preemption) {
  const Groups groups = groups_of_tiles(round.tiles, programs.lanes_of_tile, programs.lanes);
  return dispatch_in_batches(groups, buffers.ellipsoids.nearest_batches, preemption, [&] {
    buffers.ellipsoids.frame.bind_uniforms(SURFCAST_BIND_FRAME);
    buffers.ellipsoids.tiles.bind(SURFCAST_BIND_TILE_ORDER);
    buffers.ellipsoids.ids.bind(SURFCAST_BIND_GLYPH_IDS);
    buffers.ellipsoids.depths.bind(SURFCAST_BIND_GLYPH_DEPTHS);
    buffers.ellipsoids.records.bind_for_reading(SURFCAST_UNIT_SPLATS);
    buffers.ellipsoids.lists.bind_for_reading(SURFCAST_UNIT_LISTS);
    glUseProgram(programs.nearest->name());
    glUniform2ui(SURFCAST_UNIFORM_SPAN, round.tiles, round.first);
  });
}

/// Tiles with long lists in several rounds.
Status find_all_nearest(const EllipsoidWork& work, const TileLists& lists, const EllipsoidPrograms& programs,
                        SplatBuffers& buffers, const Preemption& preemption) {
  const gl::DebugGroup group("nearest ellipsoids");
  const bool several = lists.longer_than(programs.round) > 0;
  buffers.ellipsoids.depths.reserve((several ? pixels_of(work.samples) * programs.samples : 1) * sizeof(float));
  return draw_rounds(lists, programs.round,
                     [&](const ListRound& round) { return find_nearest(round, programs, buffers, preemption); });
}

int runs_of(int pixels) {
  return (pixels + 3) / 4;
}

/// Lights the samples and filters them into the picture.
Status light_and_filter(const RegionTask& task, const EllipsoidWork& work, const EllipsoidPrograms& programs,
                        SplatBuffers& buffers, const Preemption& preemption) {
  const gl::DebugGroup group("light of ellipsoids");
  EllipsoidBuffers& own = buffers.ellipsoids;
  const auto dispatch = [&](const gl::Program* program, const StorageBuffer& frame, int width, int height,
                            BatchSizer& sizer) {
    return dispatch_in_batches(all_pixels(width, height), sizer, preemption, [&, program] {
      frame.bind_uniforms(SURFCAST_BIND_FRAME);
      own.lighting.bind_uniforms(SURFCAST_BIND_GLYPH_LIGHTING);
      own.lights.bind(SURFCAST_BIND_GLYPH_LIGHTS);
      own.records.bind_for_reading(SURFCAST_UNIT_SPLATS);
      own.ids.bind(SURFCAST_BIND_GLYPH_IDS);
      own.shades.bind(SURFCAST_BIND_GLYPH_SHADES);
      own.rows.bind(SURFCAST_BIND_GLYPH_ROWS);
      buffers.picture.bind(SURFCAST_BIND_PICTURE);
      glUseProgram(program->name());
      const bool layers = work.target != EllipsoidTarget::kPicture && program != programs.filter_rows;
      const bool fronts = programs.keeps_fronts && program == programs.shade;
      if (layers) buffers.volume.layers.bind(SURFCAST_BIND_LAYERS);
      if (fronts) buffers.fronts.bind(SURFCAST_BIND_FRONTS);
      if (!layers && !fronts) return;
      glUniform4i(SURFCAST_UNIFORM_SURFACES, task.drawn.x, task.drawn.y, task.drawn.width, task.drawn.height);
    });
  };
  const Region& samples = work.samples;
  Status status = dispatch(programs.shade, own.frame, samples.width, samples.height, own.shade_batches);
  if (status) {
    status = dispatch(programs.filter_rows, own.frame, runs_of(task.drawn.width), samples.height, own.row_batches);
  }
  if (status) {
    status = dispatch(programs.filter_columns, buffers.frame, task.drawn.width, runs_of(task.drawn.height),
                      own.column_batches);
  }
  return status;
}

EllipsoidTarget target_of(const PassPlaces& places) {
  if (places.writes == Place::kSurfaces) return EllipsoidTarget::kLayers;
  return places.reads == Place::kSurfaces ? EllipsoidTarget::kBesideSurfaces : EllipsoidTarget::kPicture;
}

Result<std::optional<RegionStats>> draw_ellipsoids(const RegionTask& task, const PassPlaces& places, Programs& programs,
                                                   SplatBuffers& buffers, const Preemption& preemption) {
  const EllipsoidTarget target = target_of(places);
  const EllipsoidWork work = plan(task, target);
  const Result<EllipsoidPrograms> compiled = programs.ellipsoids(task.variant, work.plan.colored, target);
  if (!compiled) return fail(compiled);
  RegionStats stats;
  const WorkStopwatch project_watch(preemption);
  reserve(work, *compiled, buffers);
  upload_work(task, work, buffers);
  if (Status status = project(task, work, *compiled->project, buffers, preemption); !status) {
    return fail(status);
  }
  stats.project_ms = project_watch.milliseconds();

  const WorkStopwatch bin_watch(preemption);
  const std::optional<TileLists> lists = list_ellipsoids(task, work, buffers);
  if (!lists) return std::optional<RegionStats>();
  upload_lists(*lists, buffers.lazy, buffers.ellipsoids.tiles, buffers.ellipsoids.lists);
  stats.splats = lists->drawn;
  stats.bin_ms = bin_watch.milliseconds();

  const WorkStopwatch splat_watch(preemption);
  Status status = find_all_nearest(work, *lists, *compiled, buffers, preemption);
  if (status) status = light_and_filter(task, work, *compiled, buffers, preemption);
  if (!status) return fail(status);
  stats.splat_ms = splat_watch.milliseconds();
  return std::optional(stats);
}

}  // namespace

const RegionPass kEllipsoidPass{
    .draws = kinds::DrawnAs::kGlyphs, .leaves = Place::kSurfaces, .adds_to = Place::kSurfaces, .draw = draw_ellipsoids};

}  // namespace surfcast::render
