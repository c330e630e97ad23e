#include "render/visible_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace surfcast::render {
namespace {

constexpr double kNear = 0.01;  ///< steps between samples from a box at which a slice may still be drawn in it

IndexPlane normalised(const glm::dvec3& normal, double distance) {
  const double length = glm::length(normal);
  return {normal / length, distance / length};
}

/// Where a plane may lie in the sub-bricks of a brick: the least and largest of each axis' part of dot(normal, index).
class PlaneInBrick {
 public:
  PlaneInBrick(const IndexPlane& plane, const kinds::BrickBlock& block) : distance_(plane.distance) {
    const volume::BrickHeader& header = block.header();
    const auto place = [&](double sub) {  // source indices
      const glm::dvec3 first(header.brick * volume::kBrickSamples);
      return volume::source_index(block.size(), header.level, first + sub * double{volume::kSubBrickSamples});
    };
    for (size_t s = 0; s < volume::kSubBricks; ++s) {
      // A brick begins up to half a sample before its first one.
      const glm::dvec3 a = plane.normal * place(s == 0 ? -0.5 : static_cast<double>(s));
      const glm::dvec3 b = plane.normal * place(static_cast<double>(s + 1));
      least_.at(s) = glm::min(a, b);
      largest_.at(s) = glm::max(a, b);
    }
  }
  [[nodiscard]] bool cuts(const glm::ivec3& sub) const {
    return sum(least_, sub) <= distance_ + kNear && sum(largest_, sub) >= distance_ - kNear;
  }

 private:
  using Parts = std::array<glm::dvec3, volume::kSubBricks>;
  static double sum(const Parts& parts, const glm::ivec3& sub) {
    return parts.at(sub.x).x + parts.at(sub.y).y + parts.at(sub.z).z;
  }
  double distance_;
  Parts least_;
  Parts largest_;
};

}  // namespace

IndexPlane index_plane(const picture::Slice& slice, const VolumePlace& place) {
  if (slice.axis) {
    glm::dvec3 normal(0);
    normal[*slice.axis] = 1;
    return {normal, slice.index};
  }
  const glm::dvec3 unit = slice.normal / glm::length(slice.normal);
  return normalised(glm::transpose(place.axes()) * unit, glm::dot(unit, slice.point - place.index_to_world[3]));
}

VisibleParts::VisibleParts(const VolumeLook& look, const VolumePlace& place)
    : medium_(look.medium_function(place.spacing())) {
  for (const picture::IsoSurface& iso : look.isos) {
    if (iso.opacity * look.opacity > 0) isos_.push_back(iso.value);
  }
  for (const picture::Slice& slice : look.slices) {
    if (look.opacity > 0 && !look.points.empty()) slices_.push_back(index_plane(slice, place));
  }
}

bool VisibleParts::within(double low, double high) const {
  return medium_.visible_within(low, high) ||
         std::ranges::any_of(isos_, [&](double value) { return low <= value && value <= high; });
}

bool VisibleParts::cut(const volume::IndexBox& box) const {
  const glm::dvec3 centre = 0.5 * (box.low + box.high);
  const glm::dvec3 half = 0.5 * (box.high - box.low);
  return std::ranges::any_of(slices_, [&](const IndexPlane& plane) {
    return std::abs(glm::dot(plane.normal, centre) - plane.distance) <= glm::dot(glm::abs(plane.normal), half) + kNear;
  });
}

bool VisibleParts::has_iso(const volume::BrickHeader& header, const volume::CodeRange& range) const {
  return std::ranges::any_of(isos_, [&](double value) {
    // Codes 0 and 65535 stand for all beyond.
    return (range.low == 0 || header.value(range.low) <= value) &&
           (range.high == 0xffff || value <= header.value(range.high));
  });
}

void VisibleParts::mark_surfaces(const kinds::BrickBlock& block, std::span<uint32_t, SURFCAST_SEEN_WORDS> words) const {
  if (isos_.empty() && slices_.empty()) return;
  std::vector<PlaneInBrick> planes;
  for (const IndexPlane& plane : slices_) planes.emplace_back(plane, block);
  constexpr auto kSide = static_cast<int>(volume::kSubBricks);
  for (int n = 0; n < kSide * kSide * kSide; ++n) {
    const volume::CodeRange& range = block.sub_bricks()[static_cast<size_t>(n)];
    if (range.high < range.low) continue;
    const glm::ivec3 sub(n % kSide, n / kSide % kSide, n / kSide / kSide);
    const bool cut = std::ranges::any_of(planes, [&](const PlaneInBrick& plane) { return plane.cuts(sub); });
    if (cut || has_iso(block.header(), range)) words[layout::seen_word(sub)] |= 1U << layout::seen_bit(sub);
  }
}

}  // namespace surfcast::render
