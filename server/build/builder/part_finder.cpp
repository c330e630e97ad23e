#include "builder/part_finder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>

#include "geometry/zone.h"

namespace surfcast::builder {
namespace {

geometry::Box grown(const geometry::Box& box, double factor) {
  const glm::dvec3 margin = factor * box.size();
  geometry::Box larger;
  larger.min = box.min - margin;
  larger.max = box.max + margin;
  return larger;
}

/// Width of the halo around the cells of a part, as a fraction of their side. In a volume the 32 nearest neighbours of
/// a point lie within two spacings, and a cell of n points is n^(1/3) spacings wide; on a surface they lie within 3.2
/// of n^(1/2). Only cells of fewer than 43,000 points need more than kHalo.
double halo_of(const Part& part) {
  constexpr double kSpacings = 2.2;
  constexpr double kWidest = 0.25;
  const double points = static_cast<double>(part.count) / static_cast<double>(part.cells.size());
  return points > 0 ? std::clamp(kSpacings / std::cbrt(points), kHalo, kWidest) : kHalo;
}

bool any_contains(const std::vector<geometry::Box>& boxes, const glm::dvec3& p) {
  return std::any_of(boxes.begin(), boxes.end(), [&p](const geometry::Box& box) { return contains(box, p); });
}

}  // namespace

PartFinder::PartFinder(std::span<const Part> parts, const geometry::RootCube& root) : root_(root) {
  whole_ = parts.size() == 1 && parts[0].cells[0].depth == 0;
  for (const Part& part : parts) {
    std::vector<geometry::Box>& cells = cells_.emplace_back();
    std::vector<geometry::Box>& halos = with_halo_.emplace_back();
    for (const ldc::OctreeKey& key : part.cells) {
      ranges_.push_back({ldc::codes_of(key), static_cast<uint32_t>(cells_.size() - 1)});
      cells.push_back(ldc::box_of(key, root));
      halos.push_back(grown(cells.back(), halo_of(part)));
    }
  }
  std::ranges::sort(ranges_, {}, first_code);
  fill_bins();
}

void PartFinder::fill_bins() {
  constexpr double kBins = 1 << kBinDepth;
  std::vector<std::vector<uint32_t>> near(size_t{1} << (3 * kBinDepth));
  const auto bin_at = [this](const glm::dvec3& p) {
    return glm::ivec3(glm::clamp(glm::floor((p - root_.min) / root_.side * kBins), 0.0, kBins - 1));
  };
  for (uint32_t part = 0; !whole_ && part < cells_.size(); ++part) {
    for (const geometry::Box& halo : with_halo_[part]) {
      const glm::ivec3 low = bin_at(halo.min);
      const glm::ivec3 high = bin_at(halo.max);
      for (int z = low.z; z <= high.z; ++z) {
        for (int y = low.y; y <= high.y; ++y) {
          for (int x = low.x; x <= high.x; ++x) {
            const glm::dvec3 centre = (glm::dvec3(x, y, z) + 0.5) / kBins * root_.side + root_.min;
            std::vector<uint32_t>& parts = near[geometry::morton_code(root_, centre) >> kBinShift];
            if (parts.empty() || parts.back() != part) parts.push_back(part);
          }
        }
      }
    }
  }
  for (const std::vector<uint32_t>& parts : near) {
    first_of_bin_.push_back(static_cast<uint32_t>(near_bin_.size()));
    near_bin_.insert(near_bin_.end(), parts.begin(), parts.end());
  }
  first_of_bin_.push_back(static_cast<uint32_t>(near_bin_.size()));
}

uint32_t PartFinder::part_of(uint64_t code) const {
  const auto after = std::ranges::upper_bound(ranges_, code, {}, first_code);
  if (after == ranges_.begin() || code >= std::prev(after)->codes.end) return kNoPart;
  return std::prev(after)->part;
}

uint32_t PartFinder::nearest_part(const glm::dvec3& point) const {
  uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t part = 0; part < cells_.size(); ++part) {
    for (const geometry::Box& cell : cells_[part]) {
      const double distance = glm::distance(point, glm::clamp(point, cell.min, cell.max));
      if (distance < least) nearest = part;
      least = std::min(least, distance);
    }
  }
  return nearest;
}

bool PartFinder::is_near(uint32_t part, const glm::dvec3& point) const {
  return any_contains(with_halo_[part], point);
}

bool PartFinder::may_need(uint32_t part, const geometry::Box& box) const {
  return std::any_of(with_halo_[part].begin(), with_halo_[part].end(),
                     [&box](const geometry::Box& halo) { return geometry::overlap(halo, box); });
}

estimation::SitePlace PartFinder::place(uint32_t part, const glm::dvec3& point) const {
  if (whole_) return {};
  estimation::SitePlace place;
  place.own = part_of(geometry::morton_code(root_, point)) == part;
  // Neighbouring parts see this part only as far as their halo extends. In the outer half of a halo, sites have too few
  // neighbours for reliable normals.
  const auto near_side = [&](const geometry::Box& cell) {
    const geometry::Box inner = grown(cell, -kHalo / 2);
    const geometry::Box outer = grown(cell, kHalo / 2);
    return contains(outer, point) && !contains(inner, point);
  };
  place.near_border = std::any_of(cells_[part].begin(), cells_[part].end(), near_side);
  return place;
}

}  // namespace surfcast::builder
