#include "builder/part_blocks.h"

#include <utility>

#include "surfel/normalization_weights.h"

namespace surfcast::builder {
namespace {

/// The region of a part: one cell, or some of the octants of the parent of its cells.
ldc::Region region_of(const Part& part, const geometry::RootCube& root, size_t own) {
  const bool whole = part.cells.size() == 1;
  return {root, whole ? part.cells[0] : part.cells[0].parent(), whole, own};
}

}  // namespace

PartBlocks make_part_blocks(FinishedPart surfels, const Part& part, const geometry::RootCube& root,
                            std::optional<double> precision) {
  PartBlocks made{std::move(surfels.cloud), {}};
  made.cloud.weights = surfel::normalization_weights(made.cloud);
  if (surfels.own == 0) return made;
  ldc::PartitionOptions partition;
  partition.precision = precision;
  made.subtree = ldc::build_subtree(made.cloud, region_of(part, root, surfels.own), partition, 0);
  return made;
}

void renumber(uint32_t first, ldc::Subtree& subtree) {
  for (ldc::TreeBlock& block : subtree.blocks) {
    for (uint32_t& child : block.children) child += first;
  }
  for (ldc::FrontCell& cell : subtree.front) {
    for (uint32_t& block : cell.blocks) block += first;
  }
}

}  // namespace surfcast::builder
