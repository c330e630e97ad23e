#include "builder/part_finder.h"

#include <algorithm>

namespace surfcast {
namespace {

Box box_of(const OctreeKey& key, const RootCube& root) {
  const double side = std::ldexp(root.side, -int{key.depth});
  Box box;
  box.min = root.min + side * glm::dvec3(key.x, key.y, key.z);
  box.max = box.min + side;
  return box;
}

Box grown(const Box& box, double factor) {
  const glm::dvec3 margin = factor * box.size();
  Box larger;
  larger.min = box.min - margin;
  larger.max = box.max + margin;
  return larger;
}

bool contains(const Box& box, const glm::dvec3& p) {
  return p.x >= box.min.x && p.y >= box.min.y && p.z >= box.min.z && p.x <= box.max.x && p.y <= box.max.y &&
         p.z <= box.max.z;
}

bool touches(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && a.min.y <= b.max.y && a.min.z <= b.max.z && b.min.x <= a.max.x && b.min.y <= a.max.y &&
         b.min.z <= a.max.z;
}

bool any_contains(const std::vector<Box>& boxes, const glm::dvec3& p) {
  return std::any_of(boxes.begin(), boxes.end(), [&p](const Box& box) { return contains(box, p); });
}

}  // namespace

PartFinder::PartFinder(std::span<const Part> parts, const RootCube& root) : root_(root) {
  for (const Part& part : parts) {
    ends_.push_back(part.end_code);
    std::vector<Box>& cells = cells_.emplace_back();
    std::vector<Box>& halos = with_halo_.emplace_back();
    for (const OctreeKey& key : part.cells) {
      cells.push_back(box_of(key, root));
      halos.push_back(grown(cells.back(), kHalo));
    }
  }
  for (uint64_t bin = 0; bin < uint64_t{1} << (3 * kBinDepth); ++bin) {
    first_of_bin_.push_back(static_cast<uint32_t>(near_bin_.size()));
    const Box box = box_of(key_of_code(bin << kBinShift, kBinDepth), root);
    for (uint32_t part = 0; parts.size() > 1 && part < parts.size(); ++part) {
      const std::vector<Box>& halos = with_halo_[part];
      if (std::any_of(halos.begin(), halos.end(), [&box](const Box& halo) { return touches(halo, box); })) {
        near_bin_.push_back(part);
      }
    }
  }
  first_of_bin_.push_back(static_cast<uint32_t>(near_bin_.size()));
}

uint32_t PartFinder::part_of(uint64_t code) const {
  return static_cast<uint32_t>(std::upper_bound(ends_.begin(), ends_.end(), code) - ends_.begin());
}

bool PartFinder::is_near(uint32_t part, const glm::dvec3& point) const {
  return any_contains(with_halo_[part], point);
}

SitePlace PartFinder::place(uint32_t part, const glm::dvec3& point) const {
  if (ends_.size() == 1) return {};
  SitePlace place;
  place.own = part_of(morton_code(root_, point)) == part;
  // Neighbours look as far into this part as their halo reaches, and the outer half of a halo has too few neighbours to
  // say much.
  const auto near_side = [&](const Box& cell) {
    const Box inner = grown(cell, -kHalo / 2);
    const Box outer = grown(cell, kHalo / 2);
    return contains(outer, point) && !contains(inner, point);
  };
  place.near_border = std::any_of(cells_[part].begin(), cells_[part].end(), near_side);
  return place;
}

}  // namespace surfcast
