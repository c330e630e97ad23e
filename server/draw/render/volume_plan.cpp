#include "render/volume_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include "base/contract.h"
#include "render/transfer_function.h"
#include "render/visible_parts.h"

namespace surfcast::render {
namespace {

static_assert(residency::BlockPool::kPageTexels == SURFCAST_PAGE_TEXELS);
static_assert(volume::kBrickSamples == SURFCAST_BRICK && volume::kSubBrickSamples == SURFCAST_SUB_BRICK);
static_assert(volume::kHaloBefore == SURFCAST_BRICK_HALO);

glm::vec4 with(const glm::dvec3& v, double w) {
  return {glm::vec3(v), static_cast<float>(w)};
}

/// Bins of a table in which something is seen.
class SeenBins {
 public:
  explicit SeenBins(const TransferTable& table) : table_(table) {
    before_.push_back(0);
    for (size_t i = 0; i + 1 < table.sums.size(); ++i) {
      before_.push_back(before_.back() + (table.sums[i] == table.sums[i + 1] ? 0 : 1));
    }
  }
  /// True if something is seen in the bins of the values from `low` to `high`, or in one beside them.
  [[nodiscard]] bool between(double low, double high) const {
    return before_[bin_of(high + 1) + 1] > before_[bin_of(low - 1)];
  }
  [[nodiscard]] double place(double value) const { return 1 + table_.bins_per_value * (value - table_.first); }

 private:
  [[nodiscard]] size_t bin_of(double place) const {
    return static_cast<size_t>(std::clamp(place, 0.0, static_cast<double>(table_.sums.size() - 2)));
  }
  const TransferTable& table_;
  std::vector<uint32_t> before_;  ///< seen bins before each, and all
};

/// The words of the sub-bricks in which something may be seen (SURFCAST_UNIT_SEEN); all 0 if nothing is seen.
std::array<uint32_t, SURFCAST_SEEN_WORDS> seen_words(const kinds::BrickBlock& block, const SeenBins& bins) {
  const volume::BrickHeader& header = block.header();
  // The bins of codes are a linear function of them. Codes 0 and 65535 stand for all beyond.
  const double first = bins.place(header.value(0));
  const double per_code = bins.place(header.value(1)) - first;
  constexpr double kBeyond = 1e9;
  constexpr auto kSide = static_cast<int>(volume::kSubBricks);
  std::array<uint32_t, SURFCAST_SEEN_WORDS> words{};
  const volume::CodeRange* range = block.sub_bricks().data();
  for (int k = 0; k < kSide; ++k) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i, ++range) {
        if (range->high < range->low) continue;
        const double low = range->low == 0 ? -kBeyond : first + per_code * range->low;
        const double high = range->high == 0xffff ? kBeyond : first + per_code * range->high;
        const glm::ivec3 sub(i, j, k);
        if (bins.between(low, high)) words.at(layout::seen_word(sub)) |= 1U << layout::seen_bit(sub);
      }
    }
  }
  return words;
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

layout::BrickView brick_view(const VisibleBrick& brick, const TransferTable& table, uint32_t first_page) {
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
  return view;
}

/// Adds the bricks in which something can be seen. Every brick has its own cells, so the order does not matter.
void add_bricks(std::span<const VisibleBrick> bricks, const VisibleParts& visible, const TransferTable& table,
                VolumePlan& plan) {
  const SeenBins bins(table);
  const glm::u32vec3 all = volume::level_bricks(bricks.front().block->size(), 0);
  plan.cells.assign(size_t{all.x} * all.y * all.z, SURFCAST_NO_CELL);
  for (const VisibleBrick& brick : bricks) {
    auto seen = seen_words(*brick.block, bins);
    visible.mark_surfaces(*brick.block, seen);
    if (std::ranges::none_of(seen, [](uint32_t word) { return word != 0; })) continue;
    plan.seen.insert(plan.seen.end(), seen.begin(), seen.end());
    plan.bricks.push_back(brick_view(brick, table, static_cast<uint32_t>(plan.pages.size())));
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

constexpr double kLongestRayStep = 2;  ///< samples; more would pass thin bones

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

/// Distance from the eye to the nearest place of the volume, world units.
double distance_to(const VolumePlace& place, const glm::dvec3& eye) {
  const volume::IndexBox box = volume::volume_box(place.size);
  const glm::dvec3 index = glm::inverse(place.axes()) * (eye - place.index_to_world[3]);
  return glm::length(place.axes() * (index - glm::clamp(index, box.low, box.high)));
}

/// Where samples are closer than a pixel, places on rays need not be closer. Coarser levels are chosen by their
/// spacing.
double step_from_afar(std::span<const VisibleBrick> bricks, const VolumePlace& place,
                      const geometry::CameraFrame& frame) {
  const auto finest = [](const VisibleBrick& brick) { return brick.block->header().level == 0; };
  if (std::ranges::none_of(bricks, finest)) return 1;
  const double pixels = frame.eta * place.spacing() / std::max(distance_to(place, frame.eye), 1e-300);
  return std::clamp(1 / pixels, 1.0, kLongestRayStep);
}

/// `step`: between places on rays, samples of a brick's level.
void set_geometry(const VolumePlace& place, double step, const geometry::CameraFrame& frame, const Anchor& anchor,
                  layout::VolumeConstants& constants) {
  const glm::dmat3 camera_axes(frame.right, frame.up, frame.forward);
  const glm::dmat3 to_index = glm::inverse(place.axes()) * camera_axes;
  for (int i = 0; i < 3; ++i) constants.to_index[i] = with(to_index[i], anchor.index[i]);
  const glm::dvec3 towards = frame.to_camera(anchor.world);
  const double distance = glm::length(towards);
  constants.anchor = with(distance > 0 ? towards / distance : glm::dvec3(0, 0, 1), distance);
  const volume::IndexBox box = volume::volume_box(place.size);
  constants.low = with(box.low, 0);
  constants.high = with(box.high, step);
  constants.cells = glm::ivec4(glm::ivec3(volume::level_bricks(place.size, 0)), 0);
}

void add_clips(const std::vector<geometry::Box>& boxes, const Anchor& anchor, std::vector<layout::VolumeClip>& clips) {
  for (const geometry::Box& box : boxes)
    clips.push_back({with(box.min - anchor.world, 0), with(box.max - anchor.world, 0)});
}

/// Iso-surfaces and slices in bins of the transfer function.
void set_surfaces(const VolumePlace& place, const VolumeLook& look, const TransferTable& table, VolumePlan& plan) {
  constexpr size_t kMax = SURFCAST_VOLUME_SURFACES;
  SURFCAST_EXPECTS(look.isos.size() <= kMax && look.slices.size() <= kMax);
  layout::VolumeSurfaces& surfaces = plan.surfaces;
  const auto bin = [&](double value) { return static_cast<float>(1 + table.bins_per_value * (value - table.first)); };
  for (size_t i = 0; i < look.isos.size(); ++i) {
    surfaces.iso_scalars[i].x = bin(look.isos[i].value);
    surfaces.iso_colors[i] = with(linear_from_srgb(look.isos[i].color), look.isos[i].opacity * look.opacity);
  }
  for (size_t i = 0; i < look.slices.size(); ++i) {
    const IndexPlane plane = index_plane(look.slices[i], place);
    surfaces.slices[i] = with(plane.normal, plane.distance);
  }
  const bool ramped = !look.slices.empty() && !look.points.empty();
  if (!ramped) {
    plan.ramp.emplace_back(0);  // a buffer of texels is never empty
  } else {
    for (const picture::TransferPoint& p : sorted_points(look.points)) {
      plan.ramp.push_back(with(linear_from_srgb(p.color), double{bin(p.value)}));
    }
  }
  surfaces.counts = {look.isos.size(), ramped ? look.slices.size() : 0, plan.ramp.size(), look.unlit ? 0 : 1};
  surfaces.slice_opacity.x = static_cast<float>(look.opacity);
}

/// In motion, places on rays are as far apart as the spacing of the picture allows. At rest they are not.
double step_of(const picture::PictureRequest& request) {
  return request.rest_spacing ? std::clamp(request.spacing, 1.0, kLongestRayStep) : 1;
}

}  // namespace

VolumeLook look_of(const picture::PictureRequest& request) {
  const picture::VolumeOptions& options = request.volumes;
  VolumeLook look{options.transfer.points, request.clip, options.transfer.spacing};
  look.step = step_of(request);
  look.medium = options.medium;
  look.opacity = request.opacity;
  look.unlit = request.shading == picture::Shading::kUnlit;
  look.isos = options.isos;
  look.slices = options.slices;
  return look;
}

TransferFunction VolumeLook::medium_function(double grid_spacing) const {
  return {points, spacing.value_or(grid_spacing), medium ? opacity : 0};
}

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
  TransferTable table = look.medium_function(place.spacing()).table();
  const Anchor anchor = anchor_of(place, frame.eye);
  VolumePlan plan;
  add_bricks(bricks, VisibleParts(look, place), table, plan);
  set_surfaces(place, look, table, plan);
  set_geometry(place, std::max(look.step, step_from_afar(bricks, place, frame)), frame, anchor, plan.constants);
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
