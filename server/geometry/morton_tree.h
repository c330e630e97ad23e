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

/// A binary tree of boxes over points in Morton order: each node is a run of points, halved where the highest bit that
/// their codes differ in changes, so that its halves lie in different halves of an octree cell. Leaves are short runs.
class MortonTree {
 public:
  static constexpr size_t kLeaf = 12;

  /// Points of a leaf, as a run.
  struct Run {
    uint32_t first = 0;
    uint32_t last = 0;  ///< one behind
  };

  /// `codes` are ascending Morton codes of the points, at least one; `reaches`, when given, says for each point how far
  /// it is seen from. All spans must outlive the tree.
  MortonTree(std::span<const glm::dvec3> points, std::span<const uint64_t> codes, std::span<const float> reaches = {});

  /// In order; every point is in one.
  [[nodiscard]] std::vector<Run> leaves() const;
  [[nodiscard]] Box box_of(const Run& run) const;

  /// Calls `use(run)` for leaves with points within the reach of one of them of the box, and perhaps for others, until
  /// it returns false.
  template <typename Use>
  void for_each_in_reach(const Box& box, const Use& use) const {
    for_each_leaf([&box](const Node& node) { return squared_gap(node.box, box) <= node.squared_reach; }, use);
  }

 private:
  /// A node is followed by all nodes below it.
  struct Node {
    Box box;
    double squared_reach = 0;  ///< of the farthest reaching point
    Run run;
    uint32_t next = 0;  ///< the first node that is not below this one
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

  void build(std::span<const uint64_t> codes, Run run);

  std::span<const glm::dvec3> points_;
  std::span<const float> reaches_;
  std::vector<Node> nodes_;
};

}  // namespace surfcast::geometry
