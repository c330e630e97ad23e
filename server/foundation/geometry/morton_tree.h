#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/box.h"

namespace surfcast::geometry {

/// A bounding volume hierarchy (binary, of boxes) over points in Morton order. Each node is a run of points, split
/// where the highest bit in which their codes differ changes, so the two halves lie in different halves of an octree
/// cell.
class MortonTree {
 public:
  static constexpr size_t kLeaf = 12;  ///< points of a leaf, at most, where the caller does not state another number

  /// A run of consecutive points.
  struct Run {
    uint32_t first = 0;
    uint32_t last = 0;  ///< exclusive
  };

  /// `codes` are the Morton codes of the points, ascending, at least one. `reaches`, if given, has the radius of
  /// influence of each point, in the units of the points. Leaves have at most `leaf` points. Spans of points and
  /// reaches must outlive the tree.
  MortonTree(std::span<const glm::dvec3> points, std::span<const uint64_t> codes, std::span<const float> reaches = {},
             size_t leaf = kLeaf);

  /// All leaves in order. They cover every point once.
  [[nodiscard]] std::vector<Run> leaves() const;
  [[nodiscard]] Box box_of(const Run& run) const;

  /// Calls `use(run)` for each leaf that has a point within its own reach of the box, and possibly for other leaves.
  /// Stops when `use` returns false.
  template <typename Use>
  void for_each_in_reach(const Box& box, const Use& use) const {
    for_each_leaf([&box](const Node& node) { return squared_gap(node.box, box) <= node.squared_reach; }, use);
  }

  /// Calls `use(run)` for each leaf whose box is at most that far from `box`. Stops when `use` returns false.
  template <typename Use>
  void for_each_near(const Box& box, double squared_distance, const Use& use) const {
    for_each_leaf([&](const Node& node) { return squared_gap(node.box, box) <= squared_distance; }, use);
  }

  /// Calls `use(run)` for leaves whose box is at most that far from the point, mostly nearest first. `use` may lower
  /// `squared_distance`.
  template <typename Use>
  void nearest_first(const glm::dvec3& point, const double& squared_distance, const Use& use) const {
    const Box box{point, point};
    visit(0, squared_gap(nodes_[0].box, box), box, squared_distance, use);
  }

 private:
  /// Nodes are stored in depth-first order: the subtree of a node follows it.
  struct Node {
    Box box;
    double squared_reach = 0;  ///< largest of the points below
    Run run;
    uint32_t next = 0;  ///< the first node after the subtree
    bool leaf = false;
  };

  static double squared_gap(const Box& a, const Box& b) {
    const glm::dvec3 gap = glm::max(glm::max(a.min - b.max, b.min - a.max), glm::dvec3(0));
    return glm::dot(gap, gap);
  }

  template <typename Enter, typename Use>
  void for_each_leaf(const Enter& enter, const Use& use) const {
    for (uint32_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      const bool entered = enter(node);
      if (entered && node.leaf && !use(node.run)) return;
      i = entered ? i + 1 : node.next;
    }
  }

  template <typename Use>
  void visit(uint32_t node, double gap, const Box& box, const double& squared_distance, const Use& use) const {
    if (gap > squared_distance) return;
    if (nodes_[node].leaf) {
      use(nodes_[node].run);
      return;
    }
    const uint32_t lower = node + 1;
    const uint32_t upper = nodes_[lower].next;
    const double to_lower = squared_gap(nodes_[lower].box, box);
    const double to_upper = squared_gap(nodes_[upper].box, box);
    const bool swap = to_upper < to_lower;
    visit(swap ? upper : lower, swap ? to_upper : to_lower, box, squared_distance, use);
    visit(swap ? lower : upper, swap ? to_lower : to_upper, box, squared_distance, use);
  }

  void build(std::span<const uint64_t> codes, Run run);

  std::span<const glm::dvec3> points_;
  std::span<const float> reaches_;
  size_t leaf_;
  std::vector<Node> nodes_;
};

}  // namespace surfcast::geometry
