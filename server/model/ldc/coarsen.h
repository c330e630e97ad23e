#pragma once

#include <functional>

#include "ldc/subtree.h"

namespace surfcast::ldc {

/// The input from which the levels of one part of a model are made.
struct LevelSources {
  const geometry::RootCube& root;
  const CoarseAttributes& attributes;
  const surfel::SurfelCloud* cloud = nullptr;  ///< of members that are not yet sampled
  std::vector<CoarseSurfel> around = {};       ///< surfels around the part, at the same level
};

/// Replaces the cells of the front at depth + 1 by their parent cells, with one coarse block for each. Returns these
/// blocks, numbered from `first_number` on. Their weights are computed from all surfels of the level together,
/// including cells that wait for a coarser level and the surfels around the part.
std::vector<TreeBlock> coarsen(Front& front, int depth, LevelSources& sources, uint32_t first_number);

/// Depth of the deepest cell of the front.
int deepest(const Front& front);

}  // namespace surfcast::ldc
