#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ldc/coarse_surfel.h"
#include "ldc/octree_key.h"
#include "ldc/partition.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::ldc {

/// A block of a model before encoding.
struct TreeBlock {
  OctreeKey key;
  surfel::Grid grid;                          ///< the lattice of the stored positions
  std::vector<uint32_t> members;              ///< of a leaf: indices of surfels of the cloud
  std::optional<surfel::SurfelCloud> coarse;  ///< of a coarse block: its surfels, with weights
  std::vector<uint32_t> children = {};        ///< numbers of blocks that precede this one
  float ray_spacing = 0;                      ///< of a coarse block: see CoarseCell::spacing
};

/// A cell of the front, with the coarsest surfels made for it so far.
struct FrontCell {
  OctreeKey key;
  std::vector<uint32_t> blocks;  ///< numbers of the blocks that show it; small neighbouring cells may share one
  std::vector<CoarseSurfel> surfels = {};
  std::vector<uint32_t> members = {};  ///< of a leaf that is not yet sampled: indices of surfels of the cloud
  float largest_radius = 0;            ///< of the members, as they are drawn
};

/// The topmost cells of a part of a model: the input of the levels above. Fronts of different parts are joined by
/// appending one to the other.
using Front = std::vector<FrontCell>;

struct Subtree {
  std::vector<TreeBlock> blocks;  ///< children before parents; numbered from `first_number` on
  Front front;                    ///< the region's cell, or those of its eight octants that have surfels in the region
};

/// Makes the blocks of a region: leaves, and coarse blocks for all cells above them up to the region's own cell. If the
/// region is not whole, it ends with the eight octants of its cell. The cloud must have weights. The surfels around the
/// core make the coarse levels correct at the border; they should extend to 1/16 of the cell's side.
Subtree build_subtree(const surfel::SurfelCloud& cloud, const Region& region, const PartitionOptions& options,
                      uint32_t first_number);

/// Makes the coarse blocks above the fronts of all regions of a model, up to the root.
std::vector<TreeBlock> build_levels_above(Front front, const geometry::RootCube& root,
                                          const CoarseAttributes& attributes, uint32_t first_number);

}  // namespace surfcast::ldc
