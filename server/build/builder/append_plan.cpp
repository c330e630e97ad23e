#include "builder/append_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <iterator>
#include <utility>

#include "geometry/zone.h"
#include "ldc/cell_codes.h"
#include "ldc/partition.h"
#include "ldc/reduce.h"

namespace surfcast::builder {
namespace {

using ldc::OctreeKey;

geometry::Box grown_by(geometry::Box box, double margin) {
  box.min -= margin;
  box.max += margin;
  return box;
}

bool holds_strictly(const geometry::RootCube& root, const geometry::Box& box) {
  const glm::dvec3 end = root.min + root.side;
  return box.min.x >= root.min.x && box.min.y >= root.min.y && box.min.z >= root.min.z && box.max.x < end.x &&
         box.max.y < end.y && box.max.z < end.z;
}

/// Stored positions are rounded, by far less than the side of a cell.
bool is_in_its_cell(const ldc::BlockEntry& block, const geometry::RootCube& root) {
  constexpr double kTolerance = 1.0 / 16;
  const double side = std::ldexp(root.side, -int{block.key.depth});
  const geometry::Box cell = grown_by(ldc::box_of(block.key, root), std::max(block.max_radius, kTolerance * side));
  return geometry::contains(cell, block.bounds.min) && geometry::contains(cell, block.bounds.max);
}

/// A set of octants, one bit each.
using Octants = uint8_t;

bool has(Octants octants, uint32_t octant) {
  return ((octants >> octant) & 1U) != 0;
}

void include(Octants& octants, uint32_t octant) {
  octants = static_cast<Octants>(octants | (1U << octant));
}

uint32_t octant_of(const OctreeKey& key) {
  return (key.x & 1U) | (key.y & 1U) << 1U | (key.z & 1U) << 2U;
}

class AppendPlanner {
 public:
  AppendPlanner(const ldc::BlockTree& tree, const GrownRoot& root, const NewPoints& added, uint64_t limit)
      : tree_(tree), root_(root), added_(added), limit_(limit), open_(tree.blocks().size()) {
    plan_.region_of.assign(tree.blocks().size(), AppendPlan::kNoRegion);
  }

  AppendPlan plan() && {
    open_blocks();
    const std::span<const uint32_t> roots = tree_.roots();
    if (!is_coarse(roots.front())) {
      divide_cell({}, {roots.begin(), roots.end()});
      return std::move(plan_);
    }
    divide_ancestors();
    if (open_[roots.front()]) {
      divide_opened();
    } else {
      plan_.kept.push_back(roots.front());
    }
    return std::move(plan_);
  }

 private:
  using Blocks = std::vector<uint32_t>;

  [[nodiscard]] const ldc::BlockEntry& entry(uint32_t block) const { return tree_.blocks()[block]; }
  [[nodiscard]] bool is_coarse(uint32_t block) const { return tree_.children(block).count > 0; }
  [[nodiscard]] bool is_touched(const ldc::BlockEntry& leaf) const {
    return added_.any_near(leaf.bounds, kReachOverRadius * leaf.spacing);
  }

  /// A coarse block is opened if one below it is touched, or if points are added where it has no block.
  void open_blocks() {
    for (auto block = static_cast<uint32_t>(open_.size()); block-- > 0;) {
      if (is_coarse(block)) {
        open_[block] = open_[block] || added_.count(root_.key_of(entry(block).key)) > 0;
      } else {
        open_[block] = is_touched(entry(block));
      }
      const uint32_t parent = entry(block).parent;
      if (open_[block] && parent != ldc::BlockEntry::kNoParent) open_[parent] = true;
    }
  }

  /// Divides what is added outside the former root cube.
  void divide_ancestors() {
    OctreeKey inner = root_.former;
    while (inner.depth > 0) {
      const OctreeKey cell = inner.parent();
      Octants occupied = occupied_octants(cell, {});
      occupied = static_cast<Octants>(occupied & ~(1U << octant_of(inner)));
      if (occupied != 0) divide_octants(cell, occupied, {});
      inner = cell;
    }
  }

  void divide_opened() {
    for (uint32_t block = 0; block < open_.size(); ++block) {
      if (open_[block] && is_coarse(block)) divide_block(block);
    }
  }

  void divide_block(uint32_t block) {
    const auto [first, count] = tree_.children(block);
    const OctreeKey cell = root_.key_of(entry(block).key);
    Blocks leaves;
    Octants coarse = 0;
    bool touched = false;
    for (uint32_t child = first; child < first + count; ++child) {
      if (is_coarse(child)) {
        include(coarse, octant_of(entry(child).key));
        if (!open_[child]) plan_.kept.push_back(child);
      } else {
        leaves.push_back(child);
        touched = touched || open_[child];
      }
    }
    if (!touched && !adds_beside(cell, coarse)) {
      keep(leaves);
    } else if (int{cell.depth} == OctreeKey::kMaxDepth) {
      add_region({cell}, leaves);
    } else {
      divide_octants(cell, static_cast<Octants>(occupied_octants(cell, leaves) & ~coarse), leaves);
      keep(leaves);
    }
  }

  /// Copies leaves that are in no region.
  void keep(const Blocks& leaves) {
    std::ranges::copy_if(leaves, std::back_inserter(plan_.kept),
                         [this](uint32_t leaf) { return plan_.region_of[leaf] == AppendPlan::kNoRegion; });
  }

  /// Whether points are added in octants without a coarse block.
  [[nodiscard]] bool adds_beside(const OctreeKey& cell, Octants coarse) const {
    if (int{cell.depth} == OctreeKey::kMaxDepth) return added_.count(cell) > 0;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      if (!has(coarse, octant) && added_.count(cell.child(octant)) > 0) return true;
    }
    return false;
  }

  /// The octants in which there are points.
  [[nodiscard]] Octants occupied_octants(const OctreeKey& cell, const Blocks& leaves) const {
    Octants occupied = 0;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const geometry::Box box = ldc::box_of(cell.child(octant), root_.root);
      const bool any = added_.count(cell.child(octant)) > 0 || std::ranges::any_of(leaves, [&](uint32_t leaf) {
                         return geometry::overlap(box, entry(leaf).bounds);
                       });
      if (any) include(occupied, octant);
    }
    return occupied;
  }

  /// Octants that stay leaves are one region, because leaves of one parent may share blocks.
  void divide_octants(const OctreeKey& cell, Octants octants, const Blocks& leaves) {
    const uint64_t leaf = std::min<uint64_t>(ldc::PartitionOptions{}.max_surfels, limit_);
    std::vector<OctreeKey> small;
    uint64_t points = 0;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const OctreeKey child = cell.child(octant);
      const uint64_t count = added_.count(child);
      if (!has(octants, octant)) continue;
      if (count > leaf) {
        divide_cell(child, leaves);
        continue;
      }
      if (points + count > limit_) add_region(std::exchange(small, {}), leaves);
      points = small.empty() ? count : points + count;
      small.push_back(child);
    }
    if (!small.empty()) add_region(small, leaves);
  }

  /// `leaves`: those with points in the cell, and others.
  void divide_cell(const OctreeKey& cell, const Blocks& leaves) {
    if (added_.count(cell) <= limit_ || int{cell.depth} >= NewPoints::kDepth) {
      add_region({cell}, leaves);
    } else {
      divide_octants(cell, occupied_octants(cell, leaves), leaves);
    }
  }

  void add_region(const std::vector<OctreeKey>& cells, const Blocks& leaves) {
    Part part{cells, ldc::codes_of(cells.front()).first, ldc::codes_of(cells.back()).end, 0};
    for (const OctreeKey& cell : cells) part.count += added_.count(cell);
    for (const uint32_t leaf : leaves) {
      uint32_t& region = plan_.region_of[leaf];
      if (region != AppendPlan::kNoRegion) continue;
      region = static_cast<uint32_t>(plan_.regions.size());
      part.count += entry(leaf).items;
    }
    plan_.regions.push_back(std::move(part));
  }

  const ldc::BlockTree& tree_;
  const GrownRoot& root_;
  const NewPoints& added_;
  uint64_t limit_;
  std::vector<bool> open_;
  AppendPlan plan_;
};

}  // namespace

OctreeKey GrownRoot::key_of(const OctreeKey& before) const {
  return {static_cast<uint8_t>(former.depth + before.depth), (former.x << before.depth) + before.x,
          (former.y << before.depth) + before.y, (former.z << before.depth) + before.z};
}

std::optional<GrownRoot> grow_root(const geometry::RootCube& root, const geometry::Box& box, int deepest) {
  GrownRoot grown{root, {}};
  while (!holds_strictly(grown.root, box)) {
    if (grown.former.depth + deepest >= OctreeKey::kMaxDepth) return std::nullopt;
    const glm::uvec3 below(glm::lessThan(box.min, grown.root.min));
    const uint32_t cells = uint32_t{1} << grown.former.depth;
    grown.former = {static_cast<uint8_t>(grown.former.depth + 1), grown.former.x + below.x * cells,
                    grown.former.y + below.y * cells, grown.former.z + below.z * cells};
    grown.root = {grown.root.min - glm::dvec3(below) * grown.root.side, 2 * grown.root.side};
  }
  return grown;
}

std::optional<geometry::RootCube> root_of(std::span<const ldc::BlockEntry> blocks, const surfel::Grid& root_grid) {
  for (int lines = 1; lines <= ldc::kLdcLines; lines *= 2) {  // of the root block, see ldc::reduce
    const geometry::RootCube root{root_grid.offset, lines * ldc::kStepsPerRay * root_grid.scale.x};
    if (std::ranges::all_of(blocks, [&root](const ldc::BlockEntry& block) { return is_in_its_cell(block, root); })) {
      return root;
    }
  }
  return std::nullopt;
}

void NewPoints::add(std::span<const glm::dvec3> positions) {
  for (const glm::dvec3& p : positions) {
    Cell& cell = cells_[geometry::morton_code(root_, p) >> (3 * (geometry::kMortonDepth - kDepth))];
    cell.bounds.include(p);
    ++cell.points;
  }
}

void NewPoints::add(const NewPoints& more) {
  for (const auto& [code, cell] : more.cells_) {
    Cell& own = cells_[code];
    own.bounds.include(cell.bounds);
    own.points += cell.points;
  }
}

uint64_t NewPoints::count(const OctreeKey& cell) const {
  const int above = kDepth - int{cell.depth};
  const uint64_t code = geometry::interleave({cell.x, cell.y, cell.z});
  const uint64_t first = above >= 0 ? code << (3 * above) : code >> (-3 * above);
  const uint64_t end = first + (above > 0 ? uint64_t{1} << (3 * above) : 1);
  uint64_t points = 0;
  for (auto at = cells_.lower_bound(first); at != cells_.end() && at->first < end; ++at) points += at->second.points;
  return points;
}

bool NewPoints::any_near(const geometry::Box& box, double reach) const {
  constexpr uint32_t kFew = 3;
  const geometry::Box around = grown_by(box, reach);
  const auto cell_at = [this](const glm::dvec3& p) {
    return geometry::deinterleave(geometry::morton_code(root_, p) >> (3 * (geometry::kMortonDepth - kDepth)));
  };
  const glm::u32vec3 low = cell_at(around.min);
  const glm::u32vec3 high = cell_at(around.max);
  const glm::u32vec3 wide = high - low;
  if (std::max({wide.x, wide.y, wide.z}) >= kFew) return any_below({}, around);
  for (uint32_t z = low.z; z <= high.z; ++z) {
    for (uint32_t y = low.y; y <= high.y; ++y) {
      for (uint32_t x = low.x; x <= high.x; ++x) {
        const auto found = cells_.find(geometry::interleave({x, y, z}));
        if (found != cells_.end() && geometry::overlap(found->second.bounds, around)) return true;
      }
    }
  }
  return false;
}

bool NewPoints::any_below(const OctreeKey& key, const geometry::Box& box) const {
  // Rounding may put a point into the cell next to it.
  if (!geometry::overlap(grown_by(ldc::box_of(key, root_), 1e-9 * root_.side), box)) return false;
  const uint64_t first = ldc::codes_of(key).first >> (3 * (geometry::kMortonDepth - kDepth));
  const auto found = cells_.lower_bound(first);
  if (int{key.depth} == kDepth) {
    return found != cells_.end() && found->first == first && geometry::overlap(found->second.bounds, box);
  }
  if (found == cells_.end() || found->first >= first + (uint64_t{1} << (3 * (kDepth - int{key.depth})))) return false;
  for (uint32_t octant = 0; octant < 8; ++octant) {
    if (any_below(key.child(octant), box)) return true;
  }
  return false;
}

AppendPlan plan_append(const ldc::BlockTree& tree, const GrownRoot& root, const NewPoints& added, uint64_t limit) {
  return AppendPlanner(tree, root, added, limit).plan();
}

}  // namespace surfcast::builder
