#pragma once

#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "ldc/block_tree.h"
#include "point_tree/node_tree.h"

namespace surfcast::point_tree {

/// Which points of the cell of a node a block has. All of them are the points of the node and of its ancestors there.
enum class Share : uint8_t {
  kCell,    ///< all
  kOctant,  ///< those in an octant with a child
  kRest,    ///< those in the octants without a child: nothing finer stands for them
};

/// A block of the model: what it is made of.
struct BlockPlan {
  uint32_t node = 0;
  Share share = Share::kCell;
  uint8_t octant = 0;  ///< of kOctant
  bool leaf = false;   ///< has every point; another one is thinned where there are more than its entry states
  uint32_t part = 0;   ///< of so many, cut along the Morton order of the points
  uint32_t parts = 1;
};

/// The blocks of a tree of points. A cut of them replaces: a block stands for its descendants, and all leaves together
/// have every point once.
struct BlockTable {
  std::vector<ldc::BlockEntry> entries;  ///< `surfels` are upper bounds; levels are not set
  std::vector<BlockPlan> plans;          ///< of each block

  /// The numbers of the blocks of each node are not more than a few, and follow from their plans.
  std::vector<std::vector<uint32_t>> of_node;
};

/// Plans the blocks from the counts of the hierarchy alone.
///
/// A leaf of the tree of points has one block, or several siblings where its points with those of its ancestors may be
/// more than a block holds. A node with children has one block, or, where its points are expected to be more than a
/// block holds, one for each octant with a child. The octants of it that have no child have leaves of their own: a cut
/// must not lose the points there.
///
/// `bounds`: of all points. `radius`: of surfels at the spacing of the tree, world units.
BlockTable plan_blocks(const NodeTree& tree, const geometry::Box& bounds, double radius);

/// The most points of all ancestors together in the cell of a node, if they are sampled as octrees of points are: one
/// point in a cell of the spacing.
uint64_t most_points_of_ancestors(const NodeTree& tree, uint32_t node);

/// The largest radius that a surfel of a node's blocks has, world units.
double largest_radius(const NodeTree& tree, uint32_t node, double radius);

}  // namespace surfcast::point_tree
