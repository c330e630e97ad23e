#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "ldc/block_tree.h"
#include "selection/block_hull.h"

namespace surfcast::selection {

/// A tree of blocks and what selection derives from it once.
struct SelectionTree {
  explicit SelectionTree(const ldc::BlockTree& blocks) : tree(blocks), hulls(block_hulls(blocks)) {}

  const ldc::BlockTree& tree;  ///< outlives this
  std::vector<BlockHull> hulls;
};

/// When to stop refining.
struct SelectionCriteria {
  double spacing = 0;  ///< projected spacing to reach, pixels; 0 is the finest level there is
  uint64_t surfels = std::numeric_limits<uint64_t>::max();  ///< most that may be drawn
  uint32_t page = 1;                                        ///< blocks count in multiples of so many surfels
  const geometry::Clip* clip =
      nullptr;  ///< subtrees without a surfel that it shows are left out; none: nothing is cut away
};

/// A block that would make the picture better, were it resident.
struct WantedBlock {
  uint32_t block = 0;
  double urgency = 0;  ///< projected spacing of the coarser picture that it replaces, pixels; infinite for roots
};

/// The blocks of a view. A cut holds, for every leaf in view, exactly one of the leaf and its ancestors.
struct BlockSelection {
  std::vector<uint32_t> target;     ///< the cut of what is wanted, resident or not; ascending
  std::vector<uint32_t> draw;       ///< a cut of resident blocks, as near to the target as can be; ascending
  std::vector<WantedBlock> wanted;  ///< not resident, most urgent first, ancestors before descendants
  std::vector<uint32_t> refined;    ///< blocks that the target replaces by their children; ascending
  bool budget_reached = false;      ///< the budget keeps the target coarser than the spacing asked for
  /// Parts of the view for which nothing is resident: `draw` leaves them out and is a cut of the rest.
  uint32_t holes = 0;

  /// True if drawing `draw` gives what the criteria asked for, as far as the tree has it.
  [[nodiscard]] bool converged() const { return !budget_reached && draw == target; }
};

/// Chooses what to draw of a model, from the coarsest blocks down.
///
/// - What lies outside the picture, or faces away with all that is below it, is left out (may_be_visible).
/// - The block with the largest projected spacing is replaced by its children in view, all of them, until all are at
///   the wanted spacing or the budget is used up: the cut is the one of smallest error that fits. A block whose
///   children do not fit stays; others may still be refined. The roots are taken even if they alone exceed the budget.
/// - `was_refined` is `refined` of the picture before, or empty. What was refined stays so until its projected spacing
///   is a fifth below the wanted one, so that small movements do not switch levels back and forth. The wanted spacing
///   is reached all the same: switching is only ever late on the way to coarser blocks.
/// - Where a block of the target is not resident, its nearest resident ancestor stands in for it and all its siblings,
///   or, where the view just became coarser and the budget allows, its resident descendants.
///
/// Finer spacings never give coarser blocks, whatever the budget. `resident` has an element for each block.
BlockSelection select_blocks(const SelectionTree& tree, const geometry::CameraFrame& frame,
                             const SelectionCriteria& criteria, const std::vector<bool>& resident,
                             std::span<const uint32_t> was_refined = {});

/// Those of the blocks that a rectangle of the picture sees, pixels from the top left corner.
std::vector<uint32_t> blocks_in_rectangle(const SelectionTree& tree, std::span<const uint32_t> blocks,
                                          const geometry::CameraFrame& frame, double x0, double y0, double x1,
                                          double y1);

}  // namespace surfcast::selection
