#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/byte_source.h"
#include "base/result.h"
#include "geometry/box.h"
#include "ldc/octree_key.h"

namespace surfcast::point_tree {

/// A node of an additive octree of points: it has points that its ancestors lack.
struct Node {
  static constexpr uint32_t kNone = UINT32_MAX;

  ldc::OctreeKey key;
  uint64_t points = 0;
  ByteRange bytes;          ///< of its points, if they are a part of the file that describes the tree
  uint32_t parent = kNone;  ///< its number
  /// The numbers of its children by octant.
  std::array<uint32_t, 8> children{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};

  [[nodiscard]] bool leaf() const;
  /// One bit for each octant with a child.
  [[nodiscard]] uint32_t mask() const;
};

/// The cells of an octree. Points are given to cells by one rule, so that each lies in one cell of every depth.
struct Cells {
  glm::dvec3 low{0};  ///< lowest corner of the root
  double side = 1;    ///< of the root

  [[nodiscard]] double side_of(int depth) const;
  [[nodiscard]] geometry::Box box_of(const ldc::OctreeKey& key) const;
  /// The Morton code at the greatest depth of a point of a node, which is moved into the cell of the node: coordinates
  /// were rounded after the points had been given to nodes.
  [[nodiscard]] uint64_t code_of(const glm::dvec3& point, const ldc::OctreeKey& cell) const;
};

/// Cells along the side of a node, each with one point at most, that octrees of points commonly have.
inline constexpr double kCommonCells = 128;

/// The cells below a cube. An error if the box is none: its cells would not be cubes.
Result<Cells> cells_below(const geometry::Box& cube);

/// The spacing of the root as stated, or as is common if that makes no sense. World units.
double root_spacing(const Cells& cells, double stated);

/// The codes of the points in a cell: those in [first, last).
struct CodeRange {
  uint64_t first = 0;
  uint64_t last = 0;

  explicit CodeRange(const ldc::OctreeKey& cell);
  [[nodiscard]] bool contains(uint64_t code) const { return code >= first && code < last; }
};

/// An additive octree of points, without the points.
struct NodeTree {
  Cells cells;
  double spacing = 0;       ///< about the distance between neighbouring points of the root, world units
  std::vector<Node> nodes;  ///< parents before children, siblings one after another; the first one is the root

  [[nodiscard]] uint64_t points() const;
  /// "2-1-0-3": depth and place, as EPT names nodes.
  [[nodiscard]] std::string name_of(uint32_t node) const;
  /// The node and its ancestors, the root first.
  [[nodiscard]] std::vector<uint32_t> path_to(uint32_t node) const;
};

/// Brings nodes, in any order and without parents and children, into a tree. An error if it is none: a node twice, no
/// root, one whose parent is missing, one with too many points, or one deeper than an octree of blocks is. Takes no
/// more memory than nodes.
Result<NodeTree> arrange_nodes(std::vector<Node> nodes, const Cells& cells, double spacing);

}  // namespace surfcast::point_tree
