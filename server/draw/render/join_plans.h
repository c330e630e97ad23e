#pragma once

#include <span>
#include <vector>

#include "render/volume_plan.h"

namespace surfcast::render {

/// Bricks by their volumes, in the order of the volumes' numbers. The order of the bricks of a volume stays.
std::vector<std::vector<VisibleBrick>> by_volume(std::span<const VisibleBrick> bricks);

/// What the pass over several volumes reads: the tables of all plans one after another, and the constants of each
/// volume with the places of its entries in them.
struct JoinedPlan {
  std::vector<layout::VolumeConstants> constants;
  std::vector<layout::VolumeSurfaces> surfaces;
  VolumePlan tables;  ///< its constants and the ramp, which is that of all, are those of the first volume
};

/// For how many volumes a program is compiled that draws this number: a power of two.
[[nodiscard]] size_t room_for_volumes(size_t volumes);

/// Joins the plans of volumes for one region; at least one. A plan alone stays as it is.
JoinedPlan join_plans(std::vector<VolumePlan> plans);

}  // namespace surfcast::render
