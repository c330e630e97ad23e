#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ldc/coarse_surfel.h"
#include "ldc/octree_key.h"
#include "ldc/partition.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::ldc {

/// A block of a model before it is encoded.
struct TreeBlock {
  OctreeKey key;
  surfel::Grid grid;                          ///< the lattice that its positions are stored on
  std::vector<uint32_t> members;              ///< of a leaf: surfels of the cloud it was made from
  std::optional<surfel::SurfelCloud> coarse;  ///< of a coarse block: its surfels, with weights
  std::vector<uint32_t> children = {};        ///< numbers of blocks before this one
  float ray_spacing = 0;                      ///< of a coarse block: see CoarseCell::spacing
};

/// A cell as coarse as the levels made so far show it.
struct FrontCell {
  OctreeKey key;
  std::vector<uint32_t> blocks;  ///< numbers of those that show it; small neighbours may share one
  std::vector<CoarseSurfel> surfels = {};
  std::vector<uint32_t> members = {};  ///< of a leaf whose surfels are not yet sampled: surfels of the cloud
  float largest_radius = 0;            ///< of members as they are drawn
};

/// The upper end of a part of a model: what the levels above are made of. Fronts of different parts of a model are
/// joined by appending one to the other.
using Front = std::vector<FrontCell>;

struct Subtree {
  std::vector<TreeBlock> blocks;  ///< children before their parents; numbered from `first_number` on
  Front front;                    ///< the region's cell, or those of its eight parts that have surfels in the region
};

/// Makes the blocks of a region: leaves, and coarse blocks for all cells above them up to the region's own cell. A
/// region that is not whole ends with the eight parts of its cell. The cloud has weights; what lies around the core
/// makes the coarse levels right at its border, and should reach 1/16 of the cell's side.
Subtree build_subtree(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options,
                      uint32_t first_number);

/// Makes the coarse blocks above the fronts of all regions of a model, up to the root.
std::vector<TreeBlock> build_levels_above(Front front, const geometry::RootCube& root,
                                          const CoarseAttributes& attributes, uint32_t first_number);

}  // namespace surfcast::ldc
