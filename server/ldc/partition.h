#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ldc/octree_key.h"
#include "surfel/surfel_cloud.h"

namespace surfcast {

struct PartitionOptions {
  uint32_t max_surfels = 16384;     ///< a block holds at most this many
  uint32_t min_surfels = 4096;      ///< a smaller cell joins its neighbours of the same parent cell when all fit
  std::optional<double> precision;  ///< largest position error, world units; none: a fraction of each radius
};

/// One block of the finest level: a run of Partition::order.
struct BlockPlan {
  OctreeKey key;  ///< the cell that holds all its surfels; several blocks may name the same cell
  Grid grid;      ///< the lattice that its positions are stored on
  size_t first = 0;
  size_t count = 0;
};

struct Partition {
  std::vector<uint32_t> order;  ///< every surfel of the cloud once; Morton order within each block
  std::vector<BlockPlan> blocks;
};

/// Cuts the cloud into blocks along the cells of an octree. Sources on different grids never share a block; a source
/// whose positions its grid does not give back exactly is treated as one without grid. Deterministic.
Partition partition_cloud(const SurfelCloud& cloud, const PartitionOptions& options);

}  // namespace surfcast
