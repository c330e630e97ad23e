#include "point_tree/node_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "base/invalid_input.h"
#include "geometry/morton.h"

namespace surfcast::point_tree {
namespace {

/// Octants of the deepest nodes are cells of an octree of blocks, too.
constexpr int kDeepest = ldc::OctreeKey::kMaxDepth - 1;

/// Of a node: far more than octrees of points have. It bounds the blocks that are planned for a node.
constexpr uint64_t kMaxPoints = uint64_t{1} << 20;

std::string text_of_key(const ldc::OctreeKey& key) {
  return std::to_string(key.depth) + '-' + std::to_string(key.x) + '-' + std::to_string(key.y) + '-' +
         std::to_string(key.z);
}

uint32_t octant_of(const ldc::OctreeKey& key) {
  return (key.x & 1) | ((key.y & 1) << 1) | ((key.z & 1) << 2);
}

/// The number of the node of a location among sorted nodes; kNone if there is none.
uint32_t find_node(const std::vector<Node>& nodes, uint64_t location) {
  const auto found =
      std::ranges::lower_bound(nodes, location, {}, [](const Node& node) { return ldc::location_of(node.key); });
  const bool there = found != nodes.end() && ldc::location_of(found->key) == location;
  return there ? static_cast<uint32_t>(found - nodes.begin()) : Node::kNone;
}

}  // namespace

bool Node::leaf() const {
  return mask() == 0;
}

uint32_t Node::mask() const {
  uint32_t mask = 0;
  for (uint32_t octant = 0; octant < 8; ++octant) mask |= children[octant] == kNone ? 0 : 1U << octant;
  return mask;
}

double Cells::side_of(int depth) const {
  return std::ldexp(side, -depth);
}

geometry::Box Cells::box_of(const ldc::OctreeKey& key) const {
  const double step = side_of(key.depth);
  const glm::dvec3 place(key.x, key.y, key.z);
  geometry::Box box;
  box.min = low + step * place;
  box.max = low + step * (place + 1.0);
  return box;
}

uint64_t Cells::code_of(const glm::dvec3& point, const ldc::OctreeKey& cell) const {
  const int below = ldc::OctreeKey::kMaxDepth - cell.depth;
  const glm::u32vec3 first = glm::u32vec3(cell.x, cell.y, cell.z) << static_cast<uint32_t>(below);
  const glm::u32vec3 last = first + ((1U << below) - 1U);
  const double steps = std::ldexp(1.0, ldc::OctreeKey::kMaxDepth);
  const glm::dvec3 place = glm::clamp(glm::floor((point - low) / side * steps), glm::dvec3(first), glm::dvec3(last));
  return geometry::interleave(glm::u32vec3(place));
}

CodeRange::CodeRange(const ldc::OctreeKey& cell) {
  const int below = ldc::OctreeKey::kMaxDepth - cell.depth;
  const uint64_t code = geometry::interleave({cell.x, cell.y, cell.z});
  first = code << (3 * below);
  last = (code + 1) << (3 * below);
}

uint64_t NodeTree::points() const {
  uint64_t sum = 0;
  for (const Node& node : nodes) sum += node.points;
  return sum;
}

std::string NodeTree::name_of(uint32_t node) const {
  return text_of_key(nodes[node].key);
}

std::vector<uint32_t> NodeTree::path_to(uint32_t node) const {
  std::vector<uint32_t> path;
  for (uint32_t at = node; at != Node::kNone; at = nodes[at].parent) path.push_back(at);
  std::ranges::reverse(path);
  return path;
}

Result<Cells> cells_below(const geometry::Box& cube) {
  const glm::dvec3 size = cube.size();
  const double largest_error = 1e-6 * size.x;
  const bool is_cube = size.x > 0 && std::isfinite(size.x) && std::abs(size.y - size.x) <= largest_error &&
                       std::abs(size.z - size.x) <= largest_error;
  if (!is_cube) return invalid_input("the bounds of the octree are no cube");
  return Cells{cube.min, size.x};
}

double root_spacing(const Cells& cells, double stated) {
  return stated > 0 && stated <= cells.side ? stated : cells.side / kCommonCells;
}

Result<NodeTree> arrange_nodes(std::vector<Node> nodes, const Cells& cells, double spacing) {
  const auto deep = std::ranges::find_if(nodes, [](const Node& n) { return n.key.depth > kDeepest; });
  if (deep != nodes.end()) {
    return fail(ErrorKind::kUnsupported,
                "has nodes deeper than " + std::to_string(kDeepest) + " levels: " + text_of_key(deep->key));
  }
  const auto large = std::ranges::find_if(nodes, [](const Node& n) { return n.points > kMaxPoints; });
  if (large != nodes.end()) {
    return fail(ErrorKind::kUnsupported, "node " + text_of_key(large->key) + " has " + std::to_string(large->points) +
                                             " points, too many to be shown in place: build a model of the scan");
  }
  // By depth, and in Morton order within: siblings follow each other.
  const auto location = [](const Node& node) { return ldc::location_of(node.key); };
  std::ranges::sort(nodes, {}, location);
  const auto twice = std::ranges::adjacent_find(nodes, {}, location);
  if (twice != nodes.end()) return invalid_input("the hierarchy has a node twice: " + text_of_key(twice->key));
  if (nodes.empty() || nodes.front().key.depth != 0) return invalid_input("the hierarchy has no root");
  if (nodes.size() >= Node::kNone) return invalid_input("the hierarchy has too many nodes");
  for (uint32_t i = 1; i < nodes.size(); ++i) {
    const uint32_t parent = find_node(nodes, ldc::location_of(nodes[i].key.parent()));
    if (parent == Node::kNone) {
      return invalid_input("the hierarchy has a node without a parent: " + text_of_key(nodes[i].key));
    }
    nodes[i].parent = parent;
    nodes[parent].children[octant_of(nodes[i].key)] = i;
  }
  return NodeTree{cells, spacing, std::move(nodes)};
}

}  // namespace surfcast::point_tree
