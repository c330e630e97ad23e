#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/morton.h"
#include "ldc/octree_key.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::ldc {

struct PartitionOptions {
  uint32_t max_surfels = 16384;     ///< a cell with at most this many surfels is a leaf
  uint32_t min_surfels = 4096;      ///< smaller leaves of the same parent cell share blocks
  std::optional<double> precision;  ///< largest position error, world units; none: radius / kRadiusOverError
};

/// The part of a model that a cloud represents: its first `core` surfels lie in the cell, the others lie around it.
struct Region {
  geometry::RootCube root;  ///< of the whole model
  OctreeKey cell;           ///< contains the core
  bool whole = true;        ///< the core holds all surfels of the cell, not only those of some octants
  size_t core = 0;
};

/// The region of a cloud that holds a whole model.
Region whole_region(const surfel::SurfelCloud& cloud);

/// One block of the finest level: a run of Partition::order.
struct BlockPlan {
  OctreeKey key;      ///< the cell that contains all its surfels; several blocks may have the same cell
  surfel::Grid grid;  ///< the lattice of the stored positions
  size_t first = 0;
  size_t count = 0;
};

/// The surfels of one leaf in one block.
struct LeafRun {
  uint32_t block = 0;  ///< index in Partition::blocks
  size_t first = 0;    ///< index in Partition::order
  size_t count = 0;
};

/// A cell that is not subdivided. Its parent is, and therefore has a coarse block. A cell of the greatest depth that
/// holds too many surfels has one leaf as its only child, one level deeper than the octree.
struct Leaf {
  OctreeKey key;
  std::vector<LeafRun> runs;
};

struct Partition {
  std::vector<uint32_t> order;  ///< every surfel of the core once; within a leaf and block in Morton order
  std::vector<BlockPlan> blocks;
  std::vector<Leaf> leaves;
};

/// Divides the core of a region into leaves of the octree, and these into blocks. Sources on different grids never
/// share a block. A source whose grid does not reproduce its positions exactly is treated as one without a grid. A leaf
/// depends only on the surfels in its parent cell, not on how a model is divided into regions. Deterministic.
Partition partition_region(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options);

}  // namespace surfcast::ldc
