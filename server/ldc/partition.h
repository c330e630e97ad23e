#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/morton.h"
#include "ldc/octree_key.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::ldc {

struct PartitionOptions {
  uint32_t max_surfels = 16384;     ///< a cell with at most this many is a leaf
  uint32_t min_surfels = 4096;      ///< a smaller leaf shares a block with such leaves of the same parent cell
  std::optional<double> precision;  ///< largest position error, world units; none: a fraction of each radius
};

/// Which part of a model a cloud is: its first `core` surfels are what lies in the cell, others lie around it.
struct Region {
  geometry::RootCube root;  ///< of the whole model
  OctreeKey cell;           ///< holds the core
  bool whole = true;        ///< all surfels of the cell are here; otherwise those of some of its eight parts
  size_t core = 0;
};

/// The region of a cloud that is a whole model.
Region whole_region(const surfel::SurfelCloud& cloud);

/// One block of the finest level: a run of Partition::order.
struct BlockPlan {
  OctreeKey key;      ///< the cell that holds all its surfels; several blocks may name the same cell
  surfel::Grid grid;  ///< the lattice that its positions are stored on
  size_t first = 0;
  size_t count = 0;
};

/// Surfels of one leaf within one block.
struct LeafRun {
  uint32_t block = 0;  ///< in Partition::blocks
  size_t first = 0;    ///< in Partition::order
  size_t count = 0;
};

/// A cell that is not halved further. Its parent cell is, and so has a coarse block. What is still too much below the
/// smallest cell is the only child of that cell, one deeper than the octree is.
struct Leaf {
  OctreeKey key;
  std::vector<LeafRun> runs;
};

struct Partition {
  std::vector<uint32_t> order;  ///< every surfel of the core once; those of a leaf in a block along a Morton curve
  std::vector<BlockPlan> blocks;
  std::vector<Leaf> leaves;
};

/// Cuts the core of a region into leaves of the octree, and these into blocks. Sources on different grids never share a
/// block; a source whose positions its grid does not give back exactly is treated as one without grid. A leaf depends
/// on the surfels in its parent cell alone, not on how a model is cut into regions. Deterministic.
Partition partition_region(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options);

}  // namespace surfcast::ldc
