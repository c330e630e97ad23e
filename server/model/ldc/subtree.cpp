#include "ldc/subtree.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "base/contract.h"
#include "ldc/coarsen.h"
#include "surfel/drawn_radius.h"

namespace surfcast::ldc {
namespace {

std::vector<TreeBlock> leaf_blocks(const Partition& partition) {
  std::vector<TreeBlock> blocks;
  for (const BlockPlan& plan : partition.blocks) {
    const std::span members = std::span(partition.order).subspan(plan.first, plan.count);
    blocks.push_back({plan.key, plan.grid, {members.begin(), members.end()}, std::nullopt});
  }
  return blocks;
}

float largest_drawn_radius_of(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members) {
  std::vector<float> radii;
  radii.reserve(members.size());
  for (const uint32_t member : members) {
    if (!cloud.is_scatter(member)) radii.push_back(cloud.radii[member]);
  }
  return radii.empty() ? 0 : surfel::largest_drawn_radius(radii);
}

/// The largest drawn radius of each block.
std::vector<float> largest_radii(const surfel::SurfelCloud& cloud, std::span<const TreeBlock> blocks) {
  std::vector<float> largest(blocks.size());
  oneapi::tbb::parallel_for(size_t{0}, blocks.size(),
                            [&](size_t i) { largest[i] = largest_drawn_radius_of(cloud, blocks[i].members); });
  return largest;
}

Front leaf_front(const Partition& partition, std::span<const float> largest, uint32_t first_number) {
  Front front;
  for (const Leaf& leaf : partition.leaves) {
    FrontCell cell{leaf.key, {}};
    for (const LeafRun& run : leaf.runs) {
      cell.blocks.push_back(first_number + run.block);
      const std::span members = std::span(partition.order).subspan(run.first, run.count);
      cell.largest_radius = std::max(cell.largest_radius, largest[run.block]);
      cell.members.insert(cell.members.end(), members.begin(), members.end());
    }
    front.push_back(std::move(cell));
  }
  return front;
}

/// Adds the levels from above the front's deepest cells up to depth `last`.
void add_levels(Front& front, int last, LevelSources& sources, uint32_t first_number, std::vector<TreeBlock>& blocks) {
  for (int depth = deepest(front) - 1; depth >= last; --depth) {
    const auto number = static_cast<uint32_t>(first_number + blocks.size());
    std::vector<TreeBlock> level = coarsen(front, depth, sources, number);
    blocks.insert(blocks.end(), std::make_move_iterator(level.begin()), std::make_move_iterator(level.end()));
  }
}

std::vector<CoarseSurfel> surfels_around(const surfel::SurfelCloud& cloud, size_t core) {
  std::vector<uint32_t> members(cloud.size() - core);
  std::iota(members.begin(), members.end(), static_cast<uint32_t>(core));
  return sample_surfels(cloud, members, std::numeric_limits<float>::max());
}

/// Samples the remaining members of the front, so it no longer refers to the cloud.
void finish(Front& front, const surfel::SurfelCloud& cloud) {
  for (FrontCell& cell : front) {
    if (cell.members.empty()) continue;
    cell.surfels = sample_surfels(cloud, cell.members, cell.largest_radius);
    cell.members.clear();
  }
}

}  // namespace

Subtree build_subtree(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options,
                      uint32_t first_number) {
  SURFCAST_EXPECTS(cloud.weights.size() == cloud.size());
  const Partition partition = partition_region(cloud, region, options);
  Subtree subtree{leaf_blocks(partition), {}};
  subtree.front = leaf_front(partition, largest_radii(cloud, subtree.blocks), first_number);
  const CoarseAttributes attributes = coarse_attributes(cloud);
  LevelSources sources{region.root, attributes, &cloud, surfels_around(cloud, region.core)};
  const int top = region.cell.depth + (region.whole ? 0 : 1);
  add_levels(subtree.front, top, sources, first_number, subtree.blocks);
  finish(subtree.front, cloud);
  return subtree;
}

std::vector<TreeBlock> build_levels_above(Front front, const geometry::RootCube& root,
                                          const CoarseAttributes& attributes, uint32_t first_number) {
  std::vector<TreeBlock> blocks;
  LevelSources sources{root, attributes};
  add_levels(front, 0, sources, first_number, blocks);
  return blocks;
}

}  // namespace surfcast::ldc
