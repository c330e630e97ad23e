#include "model/member_levels.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "ldc/reduce.h"
#include "surfel/even_sampling.h"

namespace surfcast::model {
namespace {

using Tops = std::vector<uint32_t>;

/// The largest shared radius is that of an even sampling with so many rays, on a slanted surface. A block with more
/// surfels than it may have is made with fewer rays than ldc::kLdcLines.
constexpr int kFewestLines = ldc::kLdcLines / 4;

uint64_t surfels_of(std::span<const TopBlock> tops, const Tops& some) {
  return std::accumulate(some.begin(), some.end(), uint64_t{0},
                         [&](uint64_t sum, uint32_t top) { return sum + tops[top].entry.items; });
}

/// Divides top blocks by the octants of the box of their centres. Axes along which the box is short are not divided.
/// Blocks with one centre are not grouped.
std::vector<Tops> divided(std::span<const TopBlock> tops, const Tops& some) {
  geometry::Box centres;
  for (const uint32_t top : some) centres.include(tops[top].entry.bounds.centre());
  const glm::dvec3 size = centres.size();
  const double longest = std::max({size.x, size.y, size.z});
  std::vector<Tops> parts;
  if (!(longest > 0)) {
    for (const uint32_t top : some) parts.push_back({top});
    return parts;
  }
  std::array<Tops, 8> octants;
  for (const uint32_t top : some) {
    const glm::dvec3 centre = tops[top].entry.bounds.centre();
    size_t octant = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool high = 2 * size[axis] >= longest && centre[axis] > centres.centre()[axis];
      octant |= size_t{high} << axis;
    }
    octants.at(octant).push_back(top);
  }
  std::ranges::copy_if(octants, std::back_inserter(parts), [](const Tops& part) { return !part.empty(); });
  return parts;
}

/// The nodes in breadth first order, so that parents precede their children and siblings follow one another.
class Planner {
 public:
  explicit Planner(std::span<const TopBlock> tops) : tops_(tops) {}

  MemberLevels plan() {
    Tops all(tops_.size());
    std::iota(all.begin(), all.end(), uint32_t{0});
    if (!is_group(all)) return {};
    add_group(ldc::BlockEntry::kNoParent, std::move(all));
    for (uint32_t node = 0; node < levels_.nodes.size(); ++node) {
      if (levels_.nodes[node].top == MemberLevelNode::kShared) add_children(node);
    }
    for (auto node = levels_.nodes.rbegin(); node != levels_.nodes.rend(); ++node) {
      if (node->top == MemberLevelNode::kShared) describe(*node);
    }
    return std::move(levels_);
  }

 private:
  [[nodiscard]] bool is_group(const Tops& some) const {
    return some.size() > 1 && surfels_of(tops_, some) > ldc::kMaxCoarseSurfels;
  }

  void add_group(uint32_t parent, Tops content) {
    MemberLevelNode node;
    node.shared = static_cast<uint32_t>(levels_.shared.size());
    node.entry.parent = parent;
    node.entry.kind = tops_[content.front()].entry.kind;
    levels_.shared.emplace_back();
    contents_.push_back(std::move(content));
    levels_.nodes.push_back(node);
  }

  void add_top(uint32_t parent, uint32_t top) {
    MemberLevelNode node;
    node.top = top;
    node.entry = tops_[top].entry;
    node.entry.parent = parent;
    levels_.nodes.push_back(node);
  }

  void add_children(uint32_t parent) {
    const uint32_t shared = levels_.nodes[parent].shared;
    const auto first = static_cast<uint32_t>(levels_.nodes.size());
    for (Tops& part : divided(tops_, contents_[shared])) {
      if (is_group(part)) {
        add_group(parent, std::move(part));
      } else {
        for (const uint32_t top : part) add_top(parent, top);
      }
    }
    levels_.shared[shared].children = {first, static_cast<uint32_t>(levels_.nodes.size()) - first};
  }

  [[nodiscard]] bool is_leaf(const MemberLevelNode& node) const {
    return node.top != MemberLevelNode::kShared && tops_[node.top].leaf;
  }

  /// The entry of a shared block, from those of its children.
  void describe(MemberLevelNode& node) {
    SharedBlock& shared = levels_.shared[node.shared];
    ldc::BlockEntry& entry = node.entry;
    uint64_t surfels = 0;
    for (uint32_t i = 0; i < shared.children.count; ++i) {
      const MemberLevelNode& child = levels_.nodes[shared.children.first + i];
      entry.bounds.include(child.entry.bounds);
      entry.max_radius = std::max(entry.max_radius, child.entry.max_radius);
      entry.level = std::max(entry.level, child.entry.level + 1);
      // Surfels that have no finer ones do not make the block coarser.
      if (!is_leaf(child)) entry.spacing = std::max(entry.spacing, child.entry.spacing);
      surfels += child.entry.items;
      shared.members |= members_of(child);
      shared.oriented = shared.oriented && is_oriented(child);
    }
    shared.cube = cube_around(entry.bounds);
    const auto spacing = [&](int lines) { return surfel::kGridRadiusOverSpacing * shared.cube.side / lines; };
    entry.spacing = std::max(entry.spacing, spacing(ldc::kLdcLines));
    entry.max_radius = std::max(entry.max_radius, std::numbers::sqrt2 * spacing(kFewestLines));
    shared.max_radius = static_cast<float>(entry.max_radius);
    entry.items = static_cast<uint32_t>(std::min<uint64_t>(surfels, ldc::kMaxCoarseSurfels));
  }

  [[nodiscard]] bool is_oriented(const MemberLevelNode& node) const {
    return node.top == MemberLevelNode::kShared ? levels_.shared[node.shared].oriented : tops_[node.top].oriented;
  }

  [[nodiscard]] std::bitset<kMaxMembers> members_of(const MemberLevelNode& node) const {
    if (node.top == MemberLevelNode::kShared) return levels_.shared[node.shared].members;
    return std::bitset<kMaxMembers>().set(tops_[node.top].member);
  }

  /// A cube with the same centre as the box, and a little wider: positions of surfels are rounded.
  static geometry::RootCube cube_around(const geometry::Box& box) {
    constexpr double kMargin = 1 + 1e-6;
    const glm::dvec3 size = box.size();
    const double longest = std::max({size.x, size.y, size.z});
    const double side = longest > 0 ? kMargin * longest : 1;
    return {box.centre() - 0.5 * side, side};
  }

  std::span<const TopBlock> tops_;
  MemberLevels levels_;
  std::vector<Tops> contents_;  ///< of each shared block
};

}  // namespace

MemberLevels plan_member_levels(std::span<const TopBlock> tops) {
  return Planner(tops).plan();
}

}  // namespace surfcast::model
