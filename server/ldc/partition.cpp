#include "ldc/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/contract.h"
#include "geometry/morton.h"
#include "ldc/lattice.h"

namespace surfcast {
namespace {

/// A surfel on its way into a block. Sorting by code lines the cells of every depth up as runs.
struct Member {
  uint64_t code;
  uint32_t surfel;
  bool operator<(const Member& other) const { return code != other.code ? code < other.code : surfel < other.surfel; }
};

/// Surfels that may share blocks: of one grid, or of none.
struct Group {
  std::optional<Grid> grid;
  std::vector<Member> members;
};

bool grid_reproduces(const Grid& grid, const glm::dvec3& p) {
  // Beyond 2^52 steps from the offset the nearest index is no longer certain.
  const glm::dvec3 steps = glm::abs((p - grid.offset) / grid.scale);
  constexpr double kLimit = 4503599627370496.0;
  return steps.x < kLimit && steps.y < kLimit && steps.z < kLimit && grid.position(grid.index(p)) == p;
}

std::optional<Grid> usable_grid(const SurfelCloud& cloud, const SourceRange& source) {
  if (!source.grid) return std::nullopt;
  const std::span positions = std::span(cloud.positions).subspan(source.first, source.count);
  const bool exact = std::all_of(positions.begin(), positions.end(),
                                 [&](const glm::dvec3& p) { return grid_reproduces(*source.grid, p); });
  return exact ? source.grid : std::nullopt;
}

std::vector<Group> group_by_grid(const SurfelCloud& cloud) {
  std::vector<Group> groups;
  for (const SourceRange& source : cloud.sources) {
    const std::optional<Grid> grid = usable_grid(cloud, source);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.grid == grid; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{grid, {}});
    for (size_t i = 0; i < source.count; ++i) {
      group->members.push_back({0, static_cast<uint32_t>(source.first + i)});
    }
  }
  return groups;
}

void sort_by_code(const SurfelCloud& cloud, const RootCube& root, std::vector<Member>& members) {
  oneapi::tbb::parallel_for(size_t{0}, members.size(),
                            [&](size_t i) { members[i].code = morton_code(root, cloud.positions[members[i].surfel]); });
  oneapi::tbb::parallel_sort(members);
}

/// Cuts one group into blocks. Cells are runs of `members_`, so a cell is a span.
class Splitter {
 public:
  Splitter(const SurfelCloud& cloud, const PartitionOptions& options, Group& group)
      : cloud_(cloud), options_(options), group_(group) {}

  std::vector<BlockPlan> blocks() && { return split({group_.members.data(), group_.members.size()}, 0); }

 private:
  using Run = std::span<Member>;

  [[nodiscard]] BlockPlan plan(Run run, const OctreeKey& key, const Grid& grid) const {
    return {key, grid, static_cast<size_t>(run.data() - group_.members.data()), run.size()};
  }
  [[nodiscard]] Run run_of(const BlockPlan& block) const { return {group_.members.data() + block.first, block.count}; }

  /// The lattice for a block of these surfels; none when they need more index bits than a block has.
  [[nodiscard]] std::optional<Grid> lattice(Run run) const {
    Box box;
    float smallest = std::numeric_limits<float>::infinity();
    for (const Member& m : run) {
      box.include(cloud_.positions[m.surfel]);
      smallest = std::min(smallest, cloud_.radii[m.surfel]);
    }
    const Grid grid =
        group_.grid ? *group_.grid : choose_lattice(box, position_tolerance(smallest, options_.precision));
    return indices_fit(grid, box) ? std::optional(grid) : std::nullopt;
  }

  std::optional<BlockPlan> one_block(Run run, const OctreeKey& key) {
    if (run.size() > options_.max_surfels) return std::nullopt;
    const std::optional<Grid> grid = lattice(run);
    return grid ? std::optional(plan(run, key, *grid)) : std::nullopt;
  }

  std::vector<BlockPlan> split(Run run, int depth) {
    const OctreeKey key = key_of_code(run.front().code, depth);
    if (const auto block = one_block(run, key)) return {*block};
    if (depth == OctreeKey::kMaxDepth) return halve(run, key);
    std::vector<BlockPlan> blocks;
    for (auto first = run.begin(); first != run.end();) {
      const uint32_t octant = octant_of_code(first->code, depth);
      const auto last = std::partition_point(first, run.end(),
                                             [&](const Member& m) { return octant_of_code(m.code, depth) == octant; });
      for (const BlockPlan& block : split({first, last}, depth + 1)) append_or_merge(blocks, block, key);
      first = last;
    }
    return blocks;
  }

  /// Appends a block of the cell `key`, or joins it to the block before when either is small and both fit together.
  void append_or_merge(std::vector<BlockPlan>& blocks, const BlockPlan& block, const OctreeKey& key) {
    if (!blocks.empty() && std::min(blocks.back().count, block.count) < options_.min_surfels) {
      const BlockPlan& before = blocks.back();
      const Run both{group_.members.data() + before.first, before.count + block.count};
      if (const auto merged = one_block(both, key)) {
        blocks.back() = *merged;
        return;
      }
    }
    blocks.push_back(block);
  }

  /// Below the smallest cell: halves by the median along the longest side, down to coincident points and single ones.
  std::vector<BlockPlan> halve(Run run, const OctreeKey& key) {
    if (const auto block = one_block(run, key)) return {*block};
    Box box;
    for (const Member& m : run) box.include(cloud_.positions[m.surfel]);
    const glm::dvec3 size = box.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = run.begin() + static_cast<std::ptrdiff_t>(run.size() / 2);
    std::nth_element(run.begin(), middle, run.end(), [&](const Member& a, const Member& b) {
      const double pa = cloud_.positions[a.surfel][axis];
      const double pb = cloud_.positions[b.surfel][axis];
      return pa != pb ? pa < pb : a.surfel < b.surfel;
    });
    std::vector<BlockPlan> blocks = halve({run.begin(), middle}, key);
    const std::vector<BlockPlan> upper = halve({middle, run.end()}, key);
    blocks.insert(blocks.end(), upper.begin(), upper.end());
    return blocks;
  }

  const SurfelCloud& cloud_;
  const PartitionOptions& options_;
  Group& group_;
};

}  // namespace

Partition partition_cloud(const SurfelCloud& cloud, const PartitionOptions& options) {
  SURFCAST_EXPECTS(cloud.size() <= std::numeric_limits<uint32_t>::max());
  const RootCube root = root_cube(cloud.bounds());
  Partition partition;
  partition.order.reserve(cloud.size());
  for (Group& group : group_by_grid(cloud)) {
    if (group.members.empty()) continue;
    sort_by_code(cloud, root, group.members);
    for (BlockPlan block : Splitter(cloud, options, group).blocks()) {
      block.first += partition.order.size();
      partition.blocks.push_back(block);
    }
    for (const Member& m : group.members) partition.order.push_back(m.surfel);
  }
  SURFCAST_EXPECTS(partition.order.size() == cloud.size());
  return partition;
}

}  // namespace surfcast
