#pragma once

#include <functional>

#include "ldc/subtree.h"

namespace surfcast::ldc {

/// What the levels of one part of a model are made of.
struct LevelSources {
  const geometry::RootCube& root;
  const CoarseAttributes& attributes;
  const surfel::SurfelCloud* cloud = nullptr;  ///< of members that are not yet sampled
  std::vector<CoarseSurfel> around = {};       ///< surfels around the part, as coarse as it is
};

/// Replaces the cells of the front that are one deeper than `depth` by their parent cells, each shown by one coarse
/// block. Returns these blocks; they are numbered from `first_number` on. Their weights are found from all surfels of
/// the level together, cells that wait for a coarser level and surfels around the part included.
std::vector<TreeBlock> coarsen(Front& front, int depth, LevelSources& sources, uint32_t first_number);

/// Depth of the deepest cell of the front.
int deepest(const Front& front);

}  // namespace surfcast::ldc
