#include "render/compose_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "base/stopwatch.h"
#include "render/depth_of_region.h"
#include "render/projection_work.h"
#include "render/region_passes.h"

namespace surfcast::render {
namespace {

/// One for each value of kinds::DrawnAs. What is drawn as surfaces comes first, and what is drawn between them after.
constexpr std::array<const RegionPass*, 4> kPasses{&kSurfacePass, &kEllipsoidPass, &kGaussianPass, &kVolumePass};

std::vector<const RegionPass*> needed_passes(const RegionTask& task) {
  std::vector<const RegionPass*> needed;
  std::ranges::copy_if(kPasses, std::back_inserter(needed), [&](const RegionPass* pass) {
    return has_blocks(task, pass->draws) || (pass->also_needed != nullptr && pass->also_needed(task));
  });
  if (needed.empty()) needed.push_back(kPasses.front());  // the background
  return needed;
}

size_t pixels_drawn(const RegionTask& task) {
  return static_cast<size_t>(task.drawn.width) * static_cast<size_t>(task.drawn.height);
}

/// Makes room for what a pass is the first to use, and clears it.
void clear_places(const RegionTask& task, const PlannedPass& planned, SplatBuffers& buffers) {
  for (const Place place : planned.cleared) {
    StorageBuffer& layers = place == Place::kCodes ? buffers.gaussians.layers : buffers.volume.layers;
    layers.reserve(pixels_drawn(task) * SURFCAST_LAYERS_KEPT * SURFCAST_LAYER_WORDS * sizeof(GLuint));
    layers.clear();
  }
  if (!task.variant.depth || planned.places.writes != Place::kPicture || planned.pass->covers) return;
  buffers.fronts.reserve(pixels_drawn(task) * sizeof(float));
  buffers.fronts.clear();
}

/// Enters the region's front surfaces in the depth map of the picture.
void read_depth(const RegionTask& task, const SplatBuffers& buffers) {
  std::vector<float> fronts(pixels_drawn(task));
  const auto bytes = static_cast<GLsizeiptr>(fronts.size() * sizeof(float));
  glGetNamedBufferSubData(buffers.fronts.name(), 0, bytes, fronts.data());
  add_fronts(fronts, task.drawn, task.region, std::ldexp(1.0F, drawing_unit(task)), *task.depth);
}

/// Enters the depths that the region shows in those of the picture.
void read_shown_depths(const RegionTask& task, const SplatBuffers& buffers) {
  std::vector<selection::DepthRange> shown(pixels_drawn(task));
  const auto bytes = static_cast<GLsizeiptr>(shown.size() * sizeof(selection::DepthRange));
  glGetNamedBufferSubData(buffers.shown_depths.name(), 0, bytes, shown.data());
  const float unit = std::ldexp(1.0F, drawing_unit(task));
  for (selection::DepthRange& pixel : shown) pixel = {pixel.front * unit, pixel.opaque * unit};
  const Region& region = task.region;
  const Region& drawn = task.drawn;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const auto* row = shown.data() + static_cast<ptrdiff_t>(y - drawn.y) * drawn.width + (region.x - drawn.x);
    task.shown->enter(region.x, y, {row, static_cast<size_t>(region.width)});
  }
}

/// Reads the finished pixels, and enters their depths in the depth map and among the shown depths if these are asked
/// for. Returns the milliseconds that it took. Fails on errors of OpenGL up to here.
Result<double> read_picture(const RegionTask& task, const SplatBuffers& buffers, std::span<std::byte> pixels) {
  const Stopwatch watch;
  glGetNamedBufferSubData(buffers.picture.name(), 0, static_cast<GLsizeiptr>(pixels.size()), pixels.data());
  if (task.variant.depth) read_depth(task, buffers);
  if (task.variant.shown_depths) read_shown_depths(task, buffers);
  const double milliseconds = watch.milliseconds();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return fail(error == GL_OUT_OF_MEMORY ? ErrorKind::kLimit : ErrorKind::kInternal,
                error == GL_OUT_OF_MEMORY ? "the GPU is out of memory for this picture"
                                          : "OpenGL error " + std::to_string(error));
  }
  return milliseconds;
}

}  // namespace

std::span<const RegionPass* const> region_passes() {
  return kPasses;
}

std::vector<PlannedPass> plan_passes(std::span<const RegionPass* const> needed) {
  std::vector<PlannedPass> plan;
  std::vector<Place> used{Place::kNowhere, Place::kPicture};  // of layers those that are not to be cleared any more
  Place drawn = Place::kNowhere;
  for (const RegionPass* pass : needed) {
    const bool last = pass == needed.back();
    PlannedPass planned{pass, last ? PassPlaces{drawn, Place::kPicture} : PassPlaces{pass->adds_to, pass->leaves}, {}};
    for (const Place place : {planned.places.reads, planned.places.writes}) {
      if (std::ranges::find(used, place) != used.end()) continue;
      planned.cleared.push_back(place);
      used.push_back(place);
    }
    drawn = planned.places.writes;
    plan.push_back(std::move(planned));
  }
  return plan;
}

Result<std::optional<RegionStats>> compose_region(const RegionTask& task, Programs& programs, SplatBuffers& buffers,
                                                  const Preemption& preemption, std::span<std::byte> pixels) {
  buffers.picture.reserve(pixels.size());
  RegionStats stats;
  for (const PlannedPass& planned : plan_passes(needed_passes(task))) {
    const WorkStopwatch clear_watch(preemption);
    clear_places(task, planned, buffers);
    stats.splat_ms += clear_watch.milliseconds();
    Result<std::optional<RegionStats>> drawn = planned.pass->draw(task, planned.places, programs, buffers, preemption);
    if (!drawn || !*drawn) return drawn;
    stats += **drawn;
  }
  const Result<double> read = read_picture(task, buffers, pixels);
  if (!read) return fail(read);
  stats.read_ms = *read;
  return std::optional(stats);
}

}  // namespace surfcast::render
