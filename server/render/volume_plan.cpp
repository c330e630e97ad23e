#include "render/volume_plan.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include "base/contract.h"
#include "render/transfer_function.h"

namespace surfcast::render {
namespace {

static_assert(residency::SurfelPool::kPageSurfels == SURFCAST_PAGE_TEXELS);
static_assert(volume::kBrickSamples == SURFCAST_BRICK && volume::kSubBrickSamples == SURFCAST_SUB_BRICK);
static_assert(volume::kHaloBefore == SURFCAST_BRICK_HALO);

glm::vec4 with(const glm::dvec3& v, double w) {
  return {glm::vec3(v), static_cast<float>(w)};
}

using SubBricks = std::bitset<volume::kAllSubBricks>;

/// The sub-bricks in which something may be seen.
SubBricks seen_sub_bricks(const kinds::BrickBlock& block, const TransferFunction& transfer) {
  const volume::BrickHeader& header = block.header();
  SubBricks seen;
  for (size_t i = 0; i < seen.size(); ++i) {
    const volume::CodeRange range = block.sub_bricks().at(i);
    if (range.high < range.low) continue;
    const double margin = volume::kOvershoot * header.scale * (range.high - range.low);
    seen[i] = transfer.visible_within(header.value(range.low) - margin, header.value(range.high) + margin);
  }
  return seen;
}

/// Level 0 bricks that a brick stands for, along each axis.
struct CellRange {
  glm::u32vec3 first{0};
  glm::u32vec3 end{0};
};

CellRange cells_of(const kinds::BrickBlock& block) {
  const volume::BrickHeader& header = block.header();
  const glm::u32vec3 times = volume::halvings(block.size(), header.level);
  const glm::u32vec3 all = volume::level_bricks(block.size(), 0);
  return {header.brick << times, glm::min((header.brick + 1U) << times, all)};
}

layout::BrickView brick_view(const VisibleBrick& brick, const SubBricks& seen, const TransferTable& table,
                             uint32_t first_page) {
  const volume::BrickHeader& header = brick.block->header();
  const volume::BrickLayout layout = volume::brick_layout(header.count);
  const glm::u32vec3 last = volume::stored_size(header.count) - 3U;
  const glm::dvec3 scale = 1.0 / glm::dvec3(glm::u32vec3(1) << volume::halvings(brick.block->size(), header.level));
  const glm::dvec3 first = glm::dvec3(header.brick) * double{volume::kBrickSamples} - double{volume::kHaloBefore};
  const glm::dvec3 offset = 0.5 * scale - 0.5 - first;
  const volume::IndexBox box = volume::brick_box(brick.block->size(), header.level, header.brick);
  layout::BrickView view{};
  view.place = {first_page, layout.row, layout.slice, layout.slices_per_page};
  view.kind = {header.level, last.x | last.y << 8 | last.z << 16, 0, 0};
  view.scale = with(scale, table.bins_per_value * header.scale);
  view.offset = with(offset, 1 + table.bins_per_value * (header.offset - table.first));
  view.low = with(box.low, 0);
  view.high = with(box.high, 0);
  for (size_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) view.seen[i / 128][static_cast<int>(i / 32 % 4)] |= 1U << i % 32;
  }
  return view;
}

/// Adds the bricks in which something can be seen. Every brick has its own cells, so the order does not matter.
void add_bricks(std::span<const VisibleBrick> bricks, const TransferFunction& transfer, const TransferTable& table,
                VolumePlan& plan) {
  const glm::u32vec3 all = volume::level_bricks(bricks.front().block->size(), 0);
  plan.cells.assign(size_t{all.x} * all.y * all.z, SURFCAST_NO_CELL);
  for (const VisibleBrick& brick : bricks) {
    const SubBricks seen = seen_sub_bricks(*brick.block, transfer);
    if (seen.none()) continue;
    plan.bricks.push_back(brick_view(brick, seen, table, static_cast<uint32_t>(plan.pages.size())));
    for (const uint32_t page : brick.pages) plan.pages.push_back(page * SURFCAST_PAGE_TEXELS);
    plan.pages.push_back(0);  // read beyond the last slice, not used
    const CellRange range = cells_of(*brick.block);
    for (uint32_t k = range.first.z; k < range.end.z; ++k) {
      for (uint32_t j = range.first.y; j < range.end.y; ++j) {
        const size_t row = (size_t{k} * all.y + j) * all.x;
        std::fill(plan.cells.begin() + static_cast<ptrdiff_t>(row + range.first.x),
                  plan.cells.begin() + static_cast<ptrdiff_t>(row + range.end.x),
                  static_cast<uint32_t>(plan.bricks.size()));
      }
    }
  }
}

bool holds(const volume::IndexBox& box, const glm::dvec3& place) {
  return glm::all(glm::lessThanEqual(box.low, place)) && glm::all(glm::lessThanEqual(place, box.high));
}

/// The place from which distances on rays are counted.
struct Anchor {
  glm::dvec3 index{0};
  glm::dvec3 world{0};
};

Anchor anchor_of(const VolumePlace& place, const glm::dvec3& eye) {
  const glm::dmat3 axes = place.axes();
  const volume::IndexBox box = volume::volume_box(place.size);
  const glm::dvec3 eye_index = glm::inverse(axes) * (eye - place.index_to_world[3]);
  if (holds(box, eye_index)) return {eye_index, eye};
  const glm::dvec3 centre = 0.5 * (box.low + box.high);
  return {centre, place.index_to_world[3] + axes * centre};
}

void set_geometry(const VolumePlace& place, const VolumeLook& look, const geometry::CameraFrame& frame,
                  const Anchor& anchor, layout::VolumeConstants& constants) {
  const glm::dmat3 camera_axes(frame.right, frame.up, frame.forward);
  const glm::dmat3 to_index = glm::inverse(place.axes()) * camera_axes;
  for (int i = 0; i < 3; ++i) constants.to_index[i] = with(to_index[i], anchor.index[i]);
  const glm::dvec3 towards = frame.to_camera(anchor.world);
  const double distance = glm::length(towards);
  constants.anchor = with(distance > 0 ? towards / distance : glm::dvec3(0, 0, 1), distance);
  const volume::IndexBox box = volume::volume_box(place.size);
  constants.low = with(box.low, 0);
  constants.high = with(box.high, look.step);
  constants.cells = glm::ivec4(glm::ivec3(volume::level_bricks(place.size, 0)), 0);
}

void add_clips(const std::vector<geometry::Box>& boxes, const Anchor& anchor, std::vector<layout::VolumeClip>& clips) {
  for (const geometry::Box& box : boxes)
    clips.push_back({with(box.min - anchor.world, 0), with(box.max - anchor.world, 0)});
}

}  // namespace

glm::dmat3 VolumePlace::axes() const {
  return {index_to_world[0], index_to_world[1], index_to_world[2]};
}

double VolumePlace::spacing() const {
  return std::cbrt(std::abs(glm::determinant(axes())));
}

VolumePlan plan_volume(std::span<const VisibleBrick> bricks, const VolumeLook& look, const geometry::CameraFrame& frame,
                       const Region& region) {
  SURFCAST_EXPECTS(!bricks.empty());
  const VolumePlace place{bricks.front().block->size(), bricks.front().block->index_to_world()};
  const TransferFunction transfer(look.points, look.spacing.value_or(place.spacing()));
  TransferTable table = transfer.table();
  const Anchor anchor = anchor_of(place, frame.eye);
  VolumePlan plan;
  add_bricks(bricks, transfer, table, plan);
  set_geometry(place, look, frame, anchor, plan.constants);
  add_clips(look.clip.inside, anchor, plan.clips);
  add_clips(look.clip.outside, anchor, plan.clips);
  constexpr int kReach = SURFCAST_VOLUME_REACH;
  plan.constants.light = {region.x - kReach, region.y - kReach, region.width + 2 * kReach, region.height + 2 * kReach};
  plan.constants.transfer = {static_cast<float>(table.sums.size() - 2), static_cast<float>(table.extinction_unit),
                             static_cast<float>(table.color_unit), 0};
  plan.constants.clips = {look.clip.inside.size(), look.clip.outside.size(), 0, 0};
  plan.transfer = std::move(table.sums);
  return plan;
}

}  // namespace surfcast::render
