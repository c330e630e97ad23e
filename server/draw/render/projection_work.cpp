#include "render/projection_work.h"

#include <algorithm>
#include <cmath>

namespace surfcast::render {
namespace {

/// An upper bound of the distance of the block's surfels from the eye, world units.
double farthest_of(const residency::PackedLattice& lattice, const geometry::CameraFrame& frame) {
  return glm::length(frame.to_camera(lattice.position(glm::uvec3(0)))) +
         glm::length(lattice.step() * glm::dvec3(lattice.largest));
}

/// The constants of a block. Its origin is computed relative to the eye in double precision, so single precision never
/// represents world coordinates.
layout::BlockView block_view(const residency::ResidentBlock& block, const geometry::CameraFrame& frame, int unit) {
  const double size = std::ldexp(1.0, unit);
  return {glm::vec4(glm::vec3(frame.to_camera(block.lattice.position(glm::uvec3(0))) * size), 0),
          glm::vec4(glm::vec3(block.lattice.step() * size), 0), block.header->scale(unit)};
}

/// The depths of a block's surfels, without their radii.
DepthRange depths_of(const residency::PackedLattice& lattice, const geometry::CameraFrame& frame, int unit,
                     uint64_t items) {
  const glm::dvec3 extent = 0.5 * lattice.step() * glm::dvec3(lattice.largest);
  const double middle = frame.to_camera(lattice.position(glm::uvec3(0)) + extent).z;
  const double reach = glm::dot(glm::abs(frame.forward), extent);
  return {std::ldexp(middle - reach, unit), std::ldexp(middle + reach, unit), items};
}

/// Adds the chunks of a run, divided at the ends of pages.
void add_chunks(const VisibleBlock& block, uint32_t view, const residency::TexelRun& run,
                std::vector<layout::Chunk>& chunks) {
  const uint32_t end = run.first + run.count;
  const uint32_t flags = run.flags | (block.coarse ? SURFCAST_RUN_COARSE : 0U);
  for (uint32_t first = run.first; first < end;) {
    const uint32_t in_page = first % residency::BlockPool::kPageTexels;
    const uint32_t texel =
        block.resident->pages[first / residency::BlockPool::kPageTexels] * residency::BlockPool::kPageTexels + in_page;
    const uint32_t count = std::min(end - first, residency::BlockPool::kPageTexels - in_page);
    chunks.push_back(
        {glm::uvec4(view, texel, count | flags, residency::kMaxPackedPerSurfel * block.first_surfel + first)});
    first += count;
  }
}

/// Adds the blocks and chunks of a kind.
void plan_kind(const RegionTask& task, uint32_t kind, int unit, ProjectionWork& work) {
  std::vector<residency::TexelRun> runs;
  const size_t first = work.chunks.size();
  for (const VisibleBlock& block : task.blocks) {
    if (block.kind != kind) continue;
    const auto view = static_cast<uint32_t>(work.blocks.size());
    work.blocks.push_back(block_view(*block.resident, task.frame, unit));
    if (needs_block_displays(task.display)) {
      work.block_displays.push_back(block_display(task.display, task.request->clip, *block.resident, work.clips));
    }
    runs.clear();
    block.resident->header->add_runs(block.radii, runs);
    uint64_t items = 0;
    for (const residency::TexelRun& run : runs) {
      add_chunks(block, view, run, work.chunks);
      items += run.count;
    }
    work.depths.push_back(depths_of(block.resident->lattice, task.frame, unit, items));
  }
  work.kinds.push_back({first, work.chunks.size() - first});
}

}  // namespace

int drawing_unit(const RegionTask& task) {
  constexpr int kFarthest = 24;
  double farthest = 0;
  for (const VisibleBlock& block : task.blocks) {
    farthest = std::max(farthest, farthest_of(block.resident->lattice, task.frame));
  }
  return farthest > 0 ? kFarthest - std::ilogb(farthest) : 0;
}

bool needs_block_displays(const DisplayOptions& display) {
  return display.clipped || display.mapped();
}

bool has_blocks(const RegionTask& task, kinds::DrawnAs drawn_as) {
  return std::ranges::any_of(task.blocks,
                             [&](const VisibleBlock& block) { return task.kinds[block.kind]->drawn_as() == drawn_as; });
}

PictureKinds kinds_of(const RegionTask& task, kinds::DrawnAs drawn_as) {
  std::vector<bool> seen(task.kinds.size());
  for (const VisibleBlock& block : task.blocks) seen[block.kind] = true;
  PictureKinds kinds;
  for (uint32_t number = 0; number < seen.size(); ++number) {
    if (seen[number] && task.kinds[number]->drawn_as() == drawn_as) kinds.push_back({task.kinds[number], number});
  }
  return kinds;
}

ProjectionWork plan_work(const RegionTask& task, const PictureKinds& kinds) {
  ProjectionWork work;
  const int unit = drawing_unit(task);
  for (const PictureKind& kind : kinds) plan_kind(task, kind.number, unit, work);
  return work;
}

}  // namespace surfcast::render
