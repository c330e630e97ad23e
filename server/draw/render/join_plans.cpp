#include "render/join_plans.h"

#include <bit>
#include <map>
#include <utility>

#include "base/contract.h"

namespace surfcast::render {
namespace {

template <typename T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Appends the tables of a plan and sets the places in its constants (shared/volume_layout.h).
void append_plan(VolumePlan plan, VolumePlan& tables, layout::VolumeConstants& constants) {
  constants.cells.w = static_cast<int>(tables.cells.size());
  constants.low.w = static_cast<float>(tables.transfer.size());
  constants.clips.z = static_cast<int>(tables.clips.size());
  for (uint32_t& cell : plan.cells) {
    if (cell != SURFCAST_NO_CELL) cell += static_cast<uint32_t>(tables.bricks.size());
  }
  for (layout::BrickView& brick : plan.bricks) brick.place.x += static_cast<uint32_t>(tables.pages.size());
  append(plan.cells, tables.cells);
  append(plan.seen, tables.seen);
  append(plan.bricks, tables.bricks);
  append(plan.pages, tables.pages);
  append(plan.transfer, tables.transfer);
  append(plan.clips, tables.clips);
}

}  // namespace

std::vector<std::vector<VisibleBrick>> by_volume(std::span<const VisibleBrick> bricks) {
  std::map<uint32_t, std::vector<VisibleBrick>> volumes;
  for (const VisibleBrick& brick : bricks) volumes[brick.block->header().volume].push_back(brick);
  std::vector<std::vector<VisibleBrick>> sorted;
  sorted.reserve(volumes.size());
  for (auto& [number, own] : volumes) sorted.push_back(std::move(own));
  return sorted;
}

size_t room_for_volumes(size_t volumes) {
  return std::bit_ceil(volumes);
}

JoinedPlan join_plans(std::vector<VolumePlan> plans) {
  SURFCAST_EXPECTS(!plans.empty());
  JoinedPlan joined;
  for (VolumePlan& plan : plans) {
    layout::VolumeConstants constants = plan.constants;
    const layout::VolumeSurfaces surfaces = plan.surfaces;
    if (joined.tables.ramp.empty()) joined.tables.ramp = plan.ramp;
    append_plan(std::move(plan), joined.tables, constants);
    joined.constants.push_back(constants);
    joined.surfaces.push_back(surfaces);
  }
  joined.constants.front().clips.w = static_cast<int>(joined.constants.size());
  joined.tables.constants = joined.constants.front();
  return joined;
}

}  // namespace surfcast::render
