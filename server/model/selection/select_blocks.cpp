#include "selection/select_blocks.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "base/contract.h"

namespace surfcast::selection {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Hysteresis: the projected spacing of blocks that were refined before is multiplied by this factor.
constexpr double kReluctance = 1.25;
/// The prefilter extends a splat by up to this many pixels beyond its disc.
constexpr double kPrefilterPixels = 4;
/// Share of a block that is seen, below which it may be coarser. By pixels alone, pictures of a street and of a town
/// from 50 m lose 2.0 and 0.9 dB with 0.5, and 0.5 and 0.0 dB with 0.2. By surfels as well, the street loses 0.6 dB
/// with 0.2 (docs/performance.md).
constexpr double kMostlyHidden = 0.2;

Frustum frustum_of(const geometry::CameraFrame& frame, double x0, double y0, double x1, double y1) {
  return {frame, x0 - kPrefilterPixels, y0 - kPrefilterPixels, x1 + kPrefilterPixels, y1 + kPrefilterPixels};
}

double least_reach(const std::vector<double>* reaches, uint32_t block) {
  return reaches == nullptr ? 0 : (*reaches)[block];
}

Frustum frustum_of(const geometry::CameraFrame& frame, const std::optional<Window>& window) {
  if (!window) return frustum_of(frame, 0, 0, frame.width, frame.height);
  return frustum_of(frame, window->x0, window->y0, window->x1, window->y1);
}

class Selector {
 public:
  Selector(const SelectionTree& tree, const geometry::CameraFrame& frame, const SelectionCriteria& criteria,
           const std::vector<bool>& resident, std::span<const uint32_t> was_refined)
      : tree_(tree),
        blocks_(tree.tree.blocks()),
        frame_(frame),
        frustum_(frustum_of(frame, criteria.window)),
        criteria_(criteria),
        resident_(resident),
        was_refined_(was_refined),
        states_(blocks_.size()) {}

  BlockSelection select() {
    refine();
    std::sort(seen_.begin(), seen_.end());
    find_stand_ins();
    draw();
    want();
    return std::move(selection_);
  }

 private:
  enum class Fate : uint8_t { kUnseen, kKept, kRefined };
  struct State {
    Fate fate = Fate::kUnseen;
    bool available = false;  ///< resident blocks cover all of its visible part
    bool by_children = false;
    double spacing = 0;                    ///< projected, pixels
    double urgency = kInfinity;            ///< smallest projected spacing of its ancestors, pixels
    uint32_t entered = Visibility::kNone;  ///< of SelectionCriteria::visible: itself, or the nearest ancestor
  };
  struct Candidate {
    double spacing;
    uint32_t block;
    bool operator<(const Candidate& other) const {
      return spacing != other.spacing ? spacing < other.spacing : block > other.block;
    }
  };

  /// What blocks take of the budgets.
  struct Cost {
    uint64_t surfels = 0;
    uint64_t items = 0;

    Cost& operator+=(const Cost& more) {
      surfels += more.surfels;
      items += more.items;
      return *this;
    }
    Cost& operator-=(const Cost& less) {
      surfels -= less.surfels;
      items -= less.items;
      return *this;
    }
  };

  [[nodiscard]] Cost cost(uint32_t block) const {
    const uint64_t page = criteria_.page;
    const uint64_t items = criteria_.items == nullptr ? 0 : (*criteria_.items)[block];
    return {(blocks_[block].items + page - 1) / page * page, items};
  }
  /// Whether a budget does not hold `after`, though it would hold `before`.
  [[nodiscard]] bool exceeds(const Cost& before, const Cost& after) const {
    return (after.surfels > criteria_.surfels && after.surfels > before.surfels) ||
           (after.items > criteria_.most_items && after.items > before.items);
  }
  [[nodiscard]] bool in_view(uint32_t block) const {
    if (criteria_.hidden != nullptr && (*criteria_.hidden)[block]) return false;
    const BlockHull& hull = tree_.hulls[block];
    return may_be_visible(hull, frustum_, frame_.eye, criteria_.sides, least_reach(criteria_.reaches, block)) &&
           (criteria_.ghost_spacing || !clipped_away(block));
  }
  [[nodiscard]] bool clipped_away(uint32_t block) const {
    return criteria_.clip != nullptr && !criteria_.clip->may_show(tree_.hulls[block].centres);
  }

  /// The factor by which the spacing of a block in view may be larger because little of it is seen; infinite if nothing
  /// is.
  [[nodiscard]] double coarsening(uint32_t block) const {
    const BlockHull& hull = tree_.hulls[block];
    const double margin = margin_of(hull, least_reach(criteria_.reaches, block));
    const double seen = criteria_.visible->share_of(hull.centres, margin, states_[block].entered);
    return std::max(1.0, std::sqrt(kMostlyHidden / seen));
  }

  /// What is as fine as the coarse picture may stay so.
  [[nodiscard]] bool may_be_coarser(const State& state) const {
    return criteria_.visible != nullptr && state.spacing > criteria_.spacing &&
           state.spacing <= criteria_.visible->spacing_in(frame_);
  }

  [[nodiscard]] uint32_t entered_block(uint32_t block, uint32_t parent) const {
    if (criteria_.visible == nullptr) return Visibility::kNone;
    const uint32_t own = criteria_.visible->index_of(block);
    const bool inherits = own == Visibility::kNone && parent != ldc::BlockEntry::kNoParent;
    return inherits ? states_[parent].entered : own;
  }

  [[nodiscard]] std::span<const uint32_t> roots() const {
    return criteria_.roots == nullptr ? tree_.tree.roots() : std::span<const uint32_t>(*criteria_.roots);
  }

  template <typename Action>
  void for_children(uint32_t block, Action action) const {
    const ldc::BlockTree::Children children = tree_.tree.children(block);
    for (uint32_t i = 0; i < children.count; ++i) action(children.first + i);
  }

  /// Adds a block to the target.
  void keep(uint32_t block) {
    State& state = states_[block];
    state.fate = Fate::kKept;
    state.spacing = projected_spacing(blocks_[block], frame_);
    const uint32_t parent = blocks_[block].parent;
    if (parent != ldc::BlockEntry::kNoParent && states_[parent].fate != Fate::kUnseen) {
      state.urgency = std::min(states_[parent].urgency, states_[parent].spacing);
    }
    state.entered = entered_block(block, parent);
    seen_.push_back(block);
    if (tree_.tree.children(block).count == 0) return;
    if (criteria_.ghost_spacing && state.spacing <= *criteria_.ghost_spacing && clipped_away(block)) return;
    if (may_be_coarser(state)) state.spacing /= coarsening(block);
    const bool before = std::binary_search(was_refined_.begin(), was_refined_.end(), block);
    candidates_.push({before ? kReluctance * state.spacing : state.spacing, block});
  }

  void refine() {
    for (const uint32_t root : roots()) {
      if (!in_view(root)) continue;
      keep(root);
      used_ += cost(root);
    }
    while (!candidates_.empty() && candidates_.top().spacing > criteria_.spacing) {
      const uint32_t block = candidates_.top().block;
      candidates_.pop();
      replace_by_children(block);
    }
  }

  void replace_by_children(uint32_t block) {
    std::vector<uint32_t> seen;
    Cost refined = used_;
    refined -= cost(block);
    for_children(block, [&](uint32_t child) {
      if (!in_view(child)) return;
      seen.push_back(child);
      refined += cost(child);
    });
    if (exceeds(used_, refined)) {
      selection_.budget_reached = true;
      return;
    }
    used_ = refined;
    states_[block].fate = Fate::kRefined;
    for (const uint32_t child : seen) keep(child);
  }

  /// Bottom up: finds the blocks that resident descendants, or the block itself, cover.
  void find_stand_ins() {
    for (auto block = seen_.rbegin(); block != seen_.rend(); ++block) {
      State& state = states_[*block];
      if (state.fate == Fate::kRefined) {
        state.by_children = true;
        for_children(*block, [&](uint32_t child) {
          if (states_[child].fate != Fate::kUnseen) state.by_children &= states_[child].available;
        });
        state.available = state.by_children || resident_[*block];
      } else {
        state.available = resident_[*block] || covered_by_finer(*block);
      }
    }
  }

  /// Tries to cover a block that is not resident by resident descendants within the budget. If they do, adds them to
  /// finer_.
  bool covered_by_finer(uint32_t block) {
    std::vector<uint32_t> found;
    std::vector<uint32_t> open{block};
    Cost finer = used_;
    finer -= cost(block);
    while (!open.empty()) {
      const uint32_t next = open.back();
      open.pop_back();
      if (resident_[next]) {
        found.push_back(next);
        finer += cost(next);
      } else if (tree_.tree.children(next).count == 0) {
        return false;
      } else {
        for_children(next, [&](uint32_t child) {
          if (in_view(child)) open.push_back(child);
        });
      }
      if (finer.surfels > criteria_.surfels || finer.items > criteria_.most_items) return false;
    }
    used_ = finer;
    finer_.insert(finer_.end(), found.begin(), found.end());
    return true;
  }

  /// Top down: selects the first blocks on each path that can be drawn.
  void draw() {
    std::vector<bool> reached(blocks_.size());
    for (const uint32_t root : roots()) reached[root] = true;
    for (const uint32_t block : seen_) {
      const State& state = states_[block];
      if (state.fate == Fate::kKept) selection_.target.push_back(block);
      if (state.fate == Fate::kRefined) selection_.refined.push_back(block);
      if (!reached[block]) continue;
      const bool pass_on = state.fate == Fate::kRefined && (state.by_children || !resident_[block]);
      if (pass_on) {
        for_children(block, [&](uint32_t child) { reached[child] = true; });
      } else if (resident_[block]) {
        selection_.draw.push_back(block);
      } else if (!state.available) {
        ++selection_.holes;
      }
    }
    add_finer(reached);
  }

  /// Adds the descendants that stand in for blocks on the drawn cut.
  void add_finer(const std::vector<bool>& reached) {
    for (const uint32_t block : finer_) {
      uint32_t above = block;
      while (states_[above].fate == Fate::kUnseen) above = blocks_[above].parent;
      if (reached[above]) selection_.draw.push_back(block);
    }
    std::sort(selection_.draw.begin(), selection_.draw.end());
  }

  void want() {
    for (const uint32_t block : seen_) {
      if (!resident_[block] && !states_[block].by_children) {
        selection_.wanted.push_back({block, states_[block].urgency});
      }
    }
    std::stable_sort(selection_.wanted.begin(), selection_.wanted.end(),
                     [](const WantedBlock& a, const WantedBlock& b) { return a.urgency > b.urgency; });
  }

  const SelectionTree& tree_;
  std::span<const ldc::BlockEntry> blocks_;
  const geometry::CameraFrame& frame_;
  Frustum frustum_;
  SelectionCriteria criteria_;
  const std::vector<bool>& resident_;
  std::span<const uint32_t> was_refined_;

  std::vector<State> states_;
  std::vector<uint32_t> seen_;  ///< in view, and in the target or refined
  std::priority_queue<Candidate> candidates_;
  Cost used_;                    ///< of the budgets
  std::vector<uint32_t> finer_;  ///< descendants that stand in for blocks of the target
  BlockSelection selection_;
};

}  // namespace

BlockSelection select_blocks(const SelectionTree& tree, const geometry::CameraFrame& frame,
                             const SelectionCriteria& criteria, const std::vector<bool>& resident,
                             std::span<const uint32_t> was_refined) {
  SURFCAST_EXPECTS(resident.size() == tree.tree.blocks().size() && criteria.page > 0);
  return Selector(tree, frame, criteria, resident, was_refined).select();
}

std::vector<uint32_t> blocks_in_rectangle(const SelectionTree& tree, std::span<const uint32_t> blocks,
                                          const geometry::CameraFrame& frame, double x0, double y0, double x1,
                                          double y1, Sides sides, const std::vector<double>* reaches) {
  const Frustum frustum = frustum_of(frame, x0, y0, x1, y1);
  std::vector<uint32_t> seen;
  std::copy_if(blocks.begin(), blocks.end(), std::back_inserter(seen), [&](uint32_t block) {
    return may_be_visible(tree.hulls[block], frustum, frame.eye, sides, least_reach(reaches, block));
  });
  return seen;
}

}  // namespace surfcast::selection
