#include "ldc/subtree.h"

#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "base/contract.h"
#include "ldc/raise.h"

namespace surfcast {
namespace {

std::vector<TreeBlock> leaf_blocks(const Partition& partition) {
  std::vector<TreeBlock> blocks;
  for (const BlockPlan& plan : partition.blocks) {
    const std::span members = std::span(partition.order).subspan(plan.first, plan.count);
    blocks.push_back({plan.key, plan.grid, {members.begin(), members.end()}, std::nullopt});
  }
  return blocks;
}

Front leaf_front(const Partition& partition, uint32_t first_number) {
  Front front;
  for (const Leaf& leaf : partition.leaves) {
    FrontCell cell{leaf.key, {}};
    for (const LeafRun& run : leaf.runs) {
      cell.blocks.push_back(first_number + run.block);
      const std::span members = std::span(partition.order).subspan(run.first, run.count);
      cell.members.insert(cell.members.end(), members.begin(), members.end());
    }
    front.push_back(std::move(cell));
  }
  return front;
}

/// Adds the levels from the front's deepest cells up to those of depth `last`.
void add_levels(Front& front, int last, LevelSources& sources, uint32_t first_number, std::vector<TreeBlock>& blocks) {
  for (int depth = deepest(front) - 1; depth >= last; --depth) {
    const auto number = static_cast<uint32_t>(first_number + blocks.size());
    std::vector<TreeBlock> level = raise(front, depth, sources, number);
    blocks.insert(blocks.end(), std::make_move_iterator(level.begin()), std::make_move_iterator(level.end()));
  }
}

std::vector<CoarseSurfel> surfels_around(const SurfelCloud& cloud, size_t core) {
  std::vector<uint32_t> members(cloud.size() - core);
  std::iota(members.begin(), members.end(), static_cast<uint32_t>(core));
  return sample_surfels(cloud, members);
}

/// What is left of the front is sampled, so that it does not need the cloud any longer.
void finish(Front& front, const SurfelCloud& cloud) {
  for (FrontCell& cell : front) {
    if (cell.members.empty()) continue;
    cell.surfels = sample_surfels(cloud, cell.members);
    cell.members.clear();
  }
}

}  // namespace

Subtree build_subtree(const SurfelCloud& cloud, const Region& region, const PartitionOptions& options,
                      uint32_t first_number) {
  SURFCAST_EXPECTS(cloud.weights.size() == cloud.size());
  const Partition partition = partition_region(cloud, region, options);
  Subtree subtree{leaf_blocks(partition), leaf_front(partition, first_number)};
  const CoarseAttributes attributes = coarse_attributes(cloud);
  LevelSources sources{region.root, attributes, &cloud, surfels_around(cloud, region.core)};
  const int top = region.cell.depth + (region.whole ? 0 : 1);
  add_levels(subtree.front, top, sources, first_number, subtree.blocks);
  finish(subtree.front, cloud);
  return subtree;
}

std::vector<TreeBlock> build_levels_above(Front front, const RootCube& root, const CoarseAttributes& attributes,
                                          uint32_t first_number) {
  std::vector<TreeBlock> blocks;
  LevelSources sources{root, attributes};
  add_levels(front, 0, sources, first_number, blocks);
  return blocks;
}

}  // namespace surfcast
