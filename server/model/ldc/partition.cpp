#include "ldc/partition.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/contract.h"
#include "ldc/cell_codes.h"
#include "ldc/lattice.h"

namespace surfcast::ldc {
namespace {

/// A surfel of the core. Sorted by code, the surfels of every cell of every depth are contiguous.
struct Member {
  uint64_t code;
  uint32_t surfel;
  uint32_t group;  ///< surfels that may share blocks: those of one grid, or those without a grid
  bool operator<(const Member& other) const { return code != other.code ? code < other.code : surfel < other.surfel; }
};

using Run = std::span<Member>;

bool grid_reproduces(const surfel::Grid& grid, const glm::dvec3& p) {
  // Beyond 2^52 steps from the offset the nearest index is not exact.
  const glm::dvec3 steps = glm::abs((p - grid.offset) / grid.scale);
  constexpr double kLimit = 4503599627370496.0;
  return steps.x < kLimit && steps.y < kLimit && steps.z < kLimit && grid.position(grid.index(p)) == p;
}

std::optional<surfel::Grid> usable_grid(const surfel::SurfelCloud& cloud, const surfel::SourceRange& source) {
  if (!source.grid) return std::nullopt;
  using Range = oneapi::tbb::blocked_range<size_t>;
  const bool exact = oneapi::tbb::parallel_reduce(
      Range(source.first, source.first + source.count), true,
      [&](const Range& range, bool before) {
        const std::span positions = std::span(cloud.positions).subspan(range.begin(), range.size());
        return before && std::all_of(positions.begin(), positions.end(),
                                     [&](const glm::dvec3& p) { return grid_reproduces(*source.grid, p); });
      },
      std::logical_and<>());
  return exact ? source.grid : std::nullopt;
}

/// The members of the core in the order of their sources. Sets the grid of each group.
std::vector<Member> collect_members(const surfel::SurfelCloud& cloud, size_t core,
                                    std::vector<std::optional<surfel::Grid>>& grids) {
  std::vector<Member> members(core);
  for (const surfel::SourceRange& source : cloud.sources) {
    if (source.first >= core) break;
    const std::optional<surfel::Grid> grid = usable_grid(cloud, source);
    const auto found = std::find(grids.begin(), grids.end(), grid);
    const auto group = static_cast<uint32_t>(found - grids.begin());
    if (found == grids.end()) grids.push_back(grid);
    const size_t end = std::min(core, source.first + source.count);
    oneapi::tbb::parallel_for(source.first, end, [&](size_t i) { members[i] = {0, static_cast<uint32_t>(i), group}; });
  }
  return members;
}

/// Surfels that are read from a model may lie beyond the cell of the region, by as much as their positions were
/// rounded.
void sort_by_code(const surfel::SurfelCloud& cloud, const Region& region, std::vector<Member>& members) {
  oneapi::tbb::parallel_for(size_t{0}, members.size(), [&](size_t i) {
    const uint64_t code = geometry::morton_code(region.root, cloud.positions[members[i].surfel]);
    members[i].code = nearest_code(region.cell, code);
  });
  oneapi::tbb::parallel_sort(members);
}

/// The smallest radii of some surfels. Splats of scatter are smaller than its spacing: where there are discs, these
/// alone determine the lattice.
struct SmallestRadii {
  float disc = std::numeric_limits<float>::infinity();
  float scatter = std::numeric_limits<float>::infinity();

  void include(float radius, bool is_scatter) {
    float& smallest = is_scatter ? scatter : disc;
    smallest = std::min(smallest, radius);
  }
  void include(const SmallestRadii& other) {
    disc = std::min(disc, other.disc);
    scatter = std::min(scatter, other.scatter);
  }
  [[nodiscard]] double for_lattice() const { return double{std::isfinite(disc) ? disc : scatter}; }
};

/// Keeps the order within each group.
void sort_by_group(Run run) {
  const auto by_group = [](const Member& a, const Member& b) { return a.group < b.group; };
  if (!std::is_sorted(run.begin(), run.end(), by_group)) std::stable_sort(run.begin(), run.end(), by_group);
}

/// Appends a partition of other surfels.
void append(Partition& to, const Partition& more) {
  const size_t first = to.order.size();
  const auto block = static_cast<uint32_t>(to.blocks.size());
  to.order.insert(to.order.end(), more.order.begin(), more.order.end());
  for (BlockPlan plan : more.blocks) {
    plan.first += first;
    to.blocks.push_back(plan);
  }
  for (Leaf leaf : more.leaves) {
    for (LeafRun& run : leaf.runs) {
      run.block += block;
      run.first += first;
    }
    to.leaves.push_back(std::move(leaf));
  }
}

/// The members of one group in one cell, and the quantities that determine their lattice.
struct Part {
  uint32_t group = 0;
  Run members;
  geometry::Box box;
  SmallestRadii radii = {};
  size_t count = 0;
};

/// A leaf before its blocks are planned.
struct Cell {
  OctreeKey key;
  std::vector<Part> parts;  ///< by ascending group
  size_t count = 0;
};

class Splitter {
 public:
  Splitter(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options)
      : cloud_(cloud), region_(region), options_(options) {}

  Partition partition() && {
    members_ = collect_members(cloud_, region_.core, grids_);
    SURFCAST_EXPECTS(members_.size() == region_.core);
    sort_by_code(cloud_, region_, members_);
    std::optional<Cell> cell;
    Partition result;
    if (region_.whole) cell = make_cell(members_, region_.cell);
    if (cell) {
      plan_blocks({&*cell, 1}, region_.cell, result);
    } else {
      split(members_, region_.cell, result);
    }
    return result;
  }

 private:
  /// The lattice for a block of these members; none when the indices exceed the limit of a block.
  [[nodiscard]] std::optional<surfel::Grid> lattice(const Part& part) const {
    const surfel::Grid grid = grids_[part.group].value_or(
        choose_lattice(part.box, position_tolerance(part.radii.for_lattice(), options_.precision)));
    return indices_fit(grid, part.box, part.count) ? std::optional(grid) : std::nullopt;
  }

  [[nodiscard]] Part make_part(Run run) const {
    Part part{run.front().group, run, {}, {}, run.size()};
    for (const Member& m : run) {
      part.box.include(cloud_.positions[m.surfel]);
      part.radii.include(cloud_.radii[m.surfel], cloud_.is_scatter(m.surfel));
    }
    return part;
  }

  /// The run as a leaf; none when it has too many surfels or too large indices. A leaf is sorted by group.
  [[nodiscard]] std::optional<Cell> make_cell(Run run, const OctreeKey& key) const {
    if (run.size() > options_.max_surfels) return std::nullopt;
    sort_by_group(run);
    Cell cell{key, {}, run.size()};
    for (auto first = run.begin(); first != run.end();) {
      const auto last = std::find_if(first, run.end(), [&](const Member& m) { return m.group != first->group; });
      cell.parts.push_back(make_part({first, last}));
      first = last;
    }
    if (std::all_of(cell.parts.begin(), cell.parts.end(), [&](const Part& part) { return lattice(part); })) return cell;
    std::sort(run.begin(), run.end());
    return std::nullopt;
  }

  /// One octant of a cell that is split: a leaf that may share blocks with others, or a partition of its own.
  struct Octant {
    std::optional<Cell> small;
    Partition own;
  };

  [[nodiscard]] Octant work_on(Run run, const OctreeKey& key) const {
    Octant octant;
    std::optional<Cell> cell = make_cell(run, key);
    if (!cell) {
      split(run, key, octant.own);
    } else if (cell->count < options_.min_surfels) {
      octant.small = std::move(cell);
    } else {
      plan_blocks({&*cell, 1}, cell->key, octant.own);
    }
    return octant;
  }

  /// The members of each octant of a cell that has some.
  static std::vector<std::pair<uint32_t, Run>> octants_of(Run run, const OctreeKey& key) {
    std::vector<std::pair<uint32_t, Run>> octants;
    for (auto first = run.begin(); first != run.end();) {
      const uint32_t octant = octant_of_code(first->code, key.depth);
      const auto last = std::partition_point(
          first, run.end(), [&](const Member& m) { return octant_of_code(m.code, key.depth) == octant; });
      octants.emplace_back(octant, Run(first, last));
      first = last;
    }
    return octants;
  }

  /// Splits a run that exceeds the limits of a leaf. `key` is the cell of the run.
  void split(Run run, const OctreeKey& key, Partition& result) const {
    if (key.depth == OctreeKey::kMaxDepth) {
      split_below(run, key, result);
      return;
    }
    const std::vector<std::pair<uint32_t, Run>> runs = octants_of(run, key);
    std::vector<Octant> octants(runs.size());
    oneapi::tbb::parallel_for(size_t{0}, runs.size(),
                              [&](size_t i) { octants[i] = work_on(runs[i].second, key.child(runs[i].first)); });
    std::vector<Cell> small;
    for (Octant& octant : octants) {
      append(result, octant.own);
      if (octant.small) small.push_back(std::move(*octant.small));
    }
    join(small, key, result);
  }

  /// Plans blocks for small leaves of the cell `parent`. Consecutive leaves share a block while they fit.
  void join(std::span<const Cell> small, const OctreeKey& parent, Partition& result) const {
    for (auto first = small.begin(); first != small.end();) {
      auto last = first + 1;
      while (last != small.end() && fit_together({first, last + 1})) ++last;
      plan_blocks({first, last}, last - first == 1 ? first->key : parent, result);
      first = last;
    }
  }

  [[nodiscard]] bool fit_together(std::span<const Cell> cells) const {
    size_t count = 0;
    for (const Cell& cell : cells) count += cell.count;
    if (count > options_.max_surfels) return false;
    const std::vector<Part> parts = join_parts(cells);
    return std::all_of(parts.begin(), parts.end(), [&](const Part& part) { return lattice(part); });
  }

  /// The union of the parts of each group, without members.
  static std::vector<Part> join_parts(std::span<const Cell> cells) {
    std::vector<Part> joined;
    for (const Cell& cell : cells) {
      for (const Part& part : cell.parts) {
        auto at = std::find_if(joined.begin(), joined.end(), [&](const Part& p) { return p.group >= part.group; });
        if (at == joined.end() || at->group != part.group) at = joined.insert(at, Part{part.group, {}, {}, {}, 0});
        at->box.include(part.box);
        at->radii.include(part.radii);
        at->count += part.count;
      }
    }
    return joined;
  }

  /// Plans one block for each group of the cells.
  void plan_blocks(std::span<const Cell> cells, const OctreeKey& key, Partition& result) const {
    std::vector<Leaf> leaves;
    for (const Cell& cell : cells) leaves.push_back({cell.key, {}});
    for (const Part& all : join_parts(cells)) {
      const auto block = static_cast<uint32_t>(result.blocks.size());
      result.blocks.push_back({key, *lattice(all), result.order.size(), all.count});
      for (size_t i = 0; i < cells.size(); ++i) append_part(cells[i], all.group, block, leaves[i], result);
    }
    result.leaves.insert(result.leaves.end(), leaves.begin(), leaves.end());
  }

  static void append_part(const Cell& cell, uint32_t group, uint32_t block, Leaf& leaf, Partition& result) {
    const auto part =
        std::find_if(cell.parts.begin(), cell.parts.end(), [&](const Part& p) { return p.group == group; });
    if (part == cell.parts.end()) return;
    leaf.runs.push_back({block, result.order.size(), part->count});
    for (const Member& m : part->members) result.order.push_back(m.surfel);
  }

  /// Splits a cell of the greatest depth that exceeds the limits of a leaf.
  void split_below(Run run, const OctreeKey& key, Partition& result) const {
    Leaf leaf{key.child(0), {}};
    sort_by_group(run);
    for (auto first = run.begin(); first != run.end();) {
      const auto last = std::find_if(first, run.end(), [&](const Member& m) { return m.group != first->group; });
      halve({first, last}, key, leaf, result);
      first = last;
    }
    result.leaves.push_back(std::move(leaf));
  }

  /// Halves the members of one group at the median along their longest side, until each half fits into a block.
  void halve(Run run, const OctreeKey& key, Leaf& leaf, Partition& result) const {
    const Part part = make_part(run);
    const std::optional<surfel::Grid> grid = lattice(part);
    if (grid && run.size() <= options_.max_surfels) {
      leaf.runs.push_back({static_cast<uint32_t>(result.blocks.size()), result.order.size(), run.size()});
      result.blocks.push_back({key, *grid, result.order.size(), run.size()});
      for (const Member& m : run) result.order.push_back(m.surfel);
      return;
    }
    const glm::dvec3 size = part.box.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = run.begin() + static_cast<std::ptrdiff_t>(run.size() / 2);
    std::nth_element(run.begin(), middle, run.end(), [&](const Member& a, const Member& b) {
      const double pa = cloud_.positions[a.surfel][axis];
      const double pb = cloud_.positions[b.surfel][axis];
      return pa != pb ? pa < pb : a.surfel < b.surfel;
    });
    halve({run.begin(), middle}, key, leaf, result);
    halve({middle, run.end()}, key, leaf, result);
  }

  const surfel::SurfelCloud& cloud_;
  const Region& region_;
  const PartitionOptions& options_;
  std::vector<std::optional<surfel::Grid>> grids_;
  std::vector<Member> members_;
};

}  // namespace

Region whole_region(const surfel::SurfelCloud& cloud) {
  return {geometry::root_cube(cloud.bounds()), {}, true, cloud.size()};
}

Partition partition_region(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options) {
  SURFCAST_EXPECTS(cloud.size() <= std::numeric_limits<uint32_t>::max() && region.core <= cloud.size());
  if (region.core == 0) return {};
  Partition partition = Splitter(cloud, region, options).partition();
  SURFCAST_EXPECTS(partition.order.size() == region.core);
  return partition;
}

}  // namespace surfcast::ldc
