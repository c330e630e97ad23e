#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "ldc/block_tree.h"
#include "selection/block_hull.h"
#include "selection/visibility.h"

namespace surfcast::selection {

/// A tree of blocks and the data derived from it once for selection.
struct SelectionTree {
  explicit SelectionTree(const ldc::BlockTree& blocks) : tree(blocks), hulls(block_hulls(blocks)) {}

  const ldc::BlockTree& tree;  ///< must outlive this object
  std::vector<BlockHull> hulls;
};

/// A rectangle of a picture, pixels from the top left corner.
struct Window {
  double x0 = 0;
  double y0 = 0;
  double x1 = 0;
  double y1 = 0;
};

/// The criteria that end refinement.
struct SelectionCriteria {
  double spacing = 0;                                       ///< projected spacing to reach, pixels; 0: the finest level
  uint64_t surfels = std::numeric_limits<uint64_t>::max();  ///< budget: the most surfels to draw
  uint32_t page = 1;  ///< allocation granularity: the surfels of a block are rounded up to a multiple of this
  const geometry::Clip* clip =
      nullptr;  ///< subtrees without any surfel inside the clip are left out; null: nothing is clipped
  /// For each block: true if neither it nor a descendant shows anything; these are left out. Null: all may show.
  const std::vector<bool>* hidden = nullptr;
  Sides sides = Sides::kFront;
  /// Subtrees that the clip hides wholly are not left out, but refined to this projected spacing, in pixels.
  std::optional<double> ghost_spacing{};
  /// For each block: the least reach of its hull, where a picture draws items larger than the model states. Null: none.
  const std::vector<double>* reaches = nullptr;
  /// For each block: the items of it that count towards `most_items`. Null: none.
  const std::vector<uint32_t>* items = nullptr;
  uint64_t most_items = std::numeric_limits<uint64_t>::max();  ///< a second budget, of blocks that fill space
  std::optional<Window> window{};  ///< the part of the picture that is to be drawn; none: all of it
  /// The blocks from which refinement starts: none is below another one. Null: the roots of the tree.
  const std::vector<uint32_t>* roots = nullptr;
  /// Of a coarse picture of this view: blocks of which little is seen are refined less. Null: all are seen.
  const Visibility* visible = nullptr;
};

/// A block that is not resident and would refine the picture.
struct WantedBlock {
  uint32_t block = 0;
  double urgency = 0;  ///< projected spacing of the coarser block drawn in its place, pixels; infinite for roots
};

/// The blocks selected for a view. A cut contains, for every leaf in view, exactly one block: the leaf or an ancestor.
struct BlockSelection {
  std::vector<uint32_t> target;     ///< the required cut, resident or not; ascending
  std::vector<uint32_t> draw;       ///< a cut of resident blocks, as close to the target as possible; ascending
  std::vector<WantedBlock> wanted;  ///< blocks to load, most urgent first, ancestors before descendants
  std::vector<uint32_t> refined;    ///< blocks that the target replaces by their children; ascending
  bool budget_reached = false;      ///< the budget keeps the target coarser than the requested spacing
  /// Parts of the view without any resident block. `draw` is a cut of the rest.
  uint32_t holes = 0;

  /// True if drawing `draw` meets the criteria, as far as the tree is fine enough.
  [[nodiscard]] bool converged() const { return !budget_reached && draw == target; }
};

/// Selects the blocks of a picture, from the coarsest blocks down.
///
/// - Culling: subtrees outside the picture or facing away are left out (may_be_visible).
/// - Refinement: the block with the largest projected spacing is replaced by all its children in view, until all blocks
///   reach the requested spacing or the budget is used up. The result is the cut of smallest error that fits. A block
///   whose children exceed one of the budgets stays; others may still be refined. Roots are selected even if they
///   exceed the budgets.
/// - Visibility: if less than a fifth of a block is seen, its projected spacing counts as smaller by the root of this
///   ratio; where nothing is seen, it is not refined. The spacing of the coarse picture is reached everywhere.
/// - Hysteresis: `was_refined` is `refined` of the previous picture, or empty. A refined block stays refined until its
///   projected spacing is a fifth below the requested one. Small camera motions then do not switch levels back and
///   forth. The requested spacing is still reached, because hysteresis only delays coarsening.
/// - Stand-ins: if a block of the target is not resident, its nearest resident ancestor stands in for it and all
///   its siblings. If the view just became coarser and the budgets allow, its resident descendants stand in instead.
///
/// A finer spacing never selects coarser blocks, whatever the budget. `resident` has one element per block.
BlockSelection select_blocks(const SelectionTree& tree, const geometry::CameraFrame& frame,
                             const SelectionCriteria& criteria, const std::vector<bool>& resident,
                             std::span<const uint32_t> was_refined = {});

/// The subset of `blocks` that is visible in a rectangle of the picture, pixels from the top left corner. `reaches`:
/// see SelectionCriteria.
std::vector<uint32_t> blocks_in_rectangle(const SelectionTree& tree, std::span<const uint32_t> blocks,
                                          const geometry::CameraFrame& frame, double x0, double y0, double x1,
                                          double y1, Sides sides = Sides::kFront,
                                          const std::vector<double>* reaches = nullptr);

}  // namespace surfcast::selection
