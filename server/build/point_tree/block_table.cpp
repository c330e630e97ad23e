#include "point_tree/block_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/format.h"
#include "surfel/even_sampling.h"

namespace surfcast::point_tree {
namespace {

/// Of the side of a cell, by which the boxes of blocks extend the cell: points were placed before they were rounded.
constexpr double kMargin = 0.01;

/// Of levels that are samples: how much farther apart their surfels count than they are. They show less than the means
/// of as many surfels would, of which the levels of a model are made.
constexpr double kSampleSpacing = 1.06;

/// Levels above which a node's share of an ancestor's points counts as one point for each.
constexpr int kFarAbove = 24;

/// The number of points of a node and its ancestors in its cell, if they lie on surfaces: a quarter of those of the
/// parent, and so on.
double expected_points(const NodeTree& tree, uint32_t node) {
  double sum = 0;
  double share = 1;
  for (uint32_t at = node; at != Node::kNone; at = tree.nodes[at].parent, share /= 4) {
    sum += share * static_cast<double>(tree.nodes[at].points);
  }
  return sum;
}

/// Spacing of `points` spread over a surface that crosses a cell, world units.
double spacing_in_cell(double side, double points) {
  constexpr double kAreaOfSlantedPlane = 1.5;  // in a unit cell, about
  return side * std::sqrt(kAreaOfSlantedPlane / std::max(points, 1.0));
}

geometry::Box intersection(const geometry::Box& a, const geometry::Box& b) {
  geometry::Box both;
  both.min = glm::max(a.min, b.min);
  both.max = glm::min(a.max, b.max);
  return both;
}

class Planner {
 public:
  Planner(const NodeTree& tree, const geometry::Box& bounds, double radius)
      : tree_(tree), bounds_(bounds), radius_(radius) {
    table_.of_node.resize(tree.nodes.size());
  }

  BlockTable run() {
    add_node(0, ldc::BlockEntry::kNoParent);
    // Breadth first: the children of a block follow each other.
    for (uint32_t block = 0; block < table_.entries.size(); ++block) add_children(block);
    return std::move(table_);
  }

 private:
  /// The blocks of a node that stand for its cell, or for octants of it.
  void add_node(uint32_t number, uint32_t parent) {
    const Node& node = tree_.nodes[number];
    const double expected = expected_points(tree_, number);
    if (node.leaf()) {
      add_leaves(number, Share::kCell, parent);
    } else if (expected <= model::kMaxBlockSurfels) {
      add({number, Share::kCell}, parent, room_for(2 * expected), expected);
    } else {
      for (uint8_t octant = 0; octant < 8; ++octant) {
        if (node.children[octant] == Node::kNone) continue;
        add({number, Share::kOctant, octant}, parent, room_for(0.5 * expected), 0.25 * expected);
      }
      add_leaves(number, Share::kRest, parent);
    }
  }

  void add_children(uint32_t block) {
    const BlockPlan plan = table_.plans[block];
    if (plan.leaf) return;
    const Node& node = tree_.nodes[plan.node];
    if (plan.share == Share::kOctant) return add_node(node.children[plan.octant], block);
    for (const uint32_t child : node.children) {
      if (child != Node::kNone) add_node(child, block);
    }
    add_leaves(plan.node, Share::kRest, block);
  }

  void add_leaves(uint32_t number, Share share, uint32_t parent) {
    const Node& node = tree_.nodes[number];
    if (share == Share::kRest && node.mask() == 0xFF) return;
    const uint64_t most = node.points + most_points_of_ancestors(tree_, number);
    const auto parts = static_cast<uint32_t>((most + model::kMaxBlockSurfels - 1) / model::kMaxBlockSurfels);
    const auto room = static_cast<uint32_t>((most + parts - 1) / parts);
    for (uint32_t part = 0; part < parts; ++part) {
      add({number, share, 0, true, part, parts}, parent, room, expected_points(tree_, number));
    }
  }

  static uint32_t room_for(double points) {
    return static_cast<uint32_t>(std::clamp(points, 1024.0, double{model::kMaxBlockSurfels}));
  }

  [[nodiscard]] geometry::Box box_of(const BlockPlan& plan) const {
    const ldc::OctreeKey& key = tree_.nodes[plan.node].key;
    geometry::Box box = tree_.cells.box_of(plan.share == Share::kOctant ? key.child(plan.octant) : key);
    if (plan.share == Share::kRest) box = box_of_rest(tree_.nodes[plan.node]);
    const double margin = kMargin * tree_.cells.side_of(key.depth);
    box.min -= margin;
    box.max += margin;
    const geometry::Box inside = intersection(box, bounds_);
    return inside.empty() ? box : inside;
  }

  [[nodiscard]] geometry::Box box_of_rest(const Node& node) const {
    geometry::Box box;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      if (node.children[octant] == Node::kNone) box.include(tree_.cells.box_of(node.key.child(octant)));
    }
    return box;
  }

  /// `expected`: points, without a limit.
  void add(const BlockPlan& plan, uint32_t parent, uint32_t room, double expected) {
    const Node& node = tree_.nodes[plan.node];
    const double share = std::ldexp(1.0, -node.key.depth);
    ldc::BlockEntry entry;
    entry.parent = parent;
    entry.key = plan.share == Share::kOctant ? node.key.child(plan.octant) : node.key;
    entry.bounds = box_of(plan);
    entry.items = room;
    entry.max_radius = largest_radius(tree_, plan.node, radius_);
    entry.spacing = radius_ * share;
    if (plan.leaf) {
      // Leaves have all points, however dense they are.
      const double spacing = spacing_in_cell(tree_.cells.side_of(node.key.depth), expected);
      entry.spacing = std::min(entry.spacing, surfel::kRadiusOverSpacing * spacing);
    } else {
      entry.spacing *= kSampleSpacing;
      if (expected > room) entry.spacing *= std::sqrt(expected / room);  // thinned
    }
    table_.of_node[plan.node].push_back(static_cast<uint32_t>(table_.entries.size()));
    table_.entries.push_back(entry);
    table_.plans.push_back(plan);
  }

  const NodeTree& tree_;
  const geometry::Box& bounds_;
  const double radius_;
  BlockTable table_;
};

}  // namespace

uint64_t most_points_of_ancestors(const NodeTree& tree, uint32_t node) {
  // Cells of the spacing along a side, as stated or as is common; one more on either side for what is not aligned.
  const double stated = tree.cells.side / tree.spacing;
  const double cells = std::isfinite(stated) ? std::clamp(stated, 32.0, 1024.0) : kCommonCells;
  uint64_t sum = 0;
  int above = 1;
  for (uint32_t at = tree.nodes[node].parent; at != Node::kNone; at = tree.nodes[at].parent, ++above) {
    const double along = std::ldexp(cells, -std::min(above, kFarAbove)) + 2;
    const auto most = static_cast<uint64_t>(std::min(along * along * along, 1e9));
    sum += std::min(tree.nodes[at].points, most);
  }
  return sum;
}

double largest_radius(const NodeTree& tree, uint32_t node, double radius) {
  constexpr double kOfCell = 0.1;   // a dozen spacings
  constexpr double kOfSpacing = 3;  // where points are few
  const Node& at = tree.nodes[node];
  const double side = tree.cells.side_of(at.key.depth);
  const double sparse = kOfSpacing * spacing_in_cell(side, expected_points(tree, node));
  return std::max(std::clamp(sparse, kOfCell * side, side), 4 * std::ldexp(radius, -at.key.depth));
}

BlockTable plan_blocks(const NodeTree& tree, const geometry::Box& bounds, double radius) {
  return Planner(tree, bounds, radius).run();
}

}  // namespace surfcast::point_tree
