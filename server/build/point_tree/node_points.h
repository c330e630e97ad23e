#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/byte_source.h"
#include "base/result.h"
#include "geometry/box.h"
#include "point_tree/node_tree.h"
#include "scan/point_table.h"
#include "scan/row_source.h"
#include "scan/scan_points.h"
#include "scan/table_meaning.h"

namespace surfcast::point_tree {

/// Reads the points of nodes. Safe to use from several threads at once.
class NodeReader {
 public:
  virtual ~NodeReader() = default;

  [[nodiscard]] virtual const scan::RowTraits& traits() const = 0;
  [[nodiscard]] virtual const std::vector<scan::ColumnInfo>& columns() const = 0;
  /// The file that describes the tree.
  [[nodiscard]] virtual const ByteSource& source() const = 0;
  /// See ByteSource; of all files.
  [[nodiscard]] virtual std::string version() const { return source().version(); }
  /// Announces nodes that are about to be read, most urgent first. Returns at once.
  virtual void prefetch(std::span<const Node> nodes) const = 0;
  /// A node that was announced will not be read.
  virtual void forget(const Node& node) const = 0;
  /// All points of a node, in a table that refers to nothing else.
  [[nodiscard]] virtual Result<scan::PointTable> read(const Node& node) const = 0;
};

/// A tree of points that has been opened.
struct OpenedTree {
  std::unique_ptr<const NodeReader> reader;
  NodeTree tree;
  geometry::Box bounds;  ///< of all points, as stated
};

/// The points of a node, along the Morton order of the cells.
struct NodePoints {
  scan::ScanPoints points;
  std::vector<uint64_t> codes;  ///< see Cells::code_of; ascending

  [[nodiscard]] size_t bytes() const;
};

/// What the columns of a tree mean, by the points of its root: they are spread over all of it.
Result<scan::TableMeaning> decide_meaning(const NodeReader& reader, const scan::PointTable& root);

/// Converts and sorts the points of a node. Those without coordinates are left out. An error if points lie outside the
/// cell of the node.
Result<NodePoints> sort_points(const scan::PointTable& table, const scan::TableMeaning& meaning, const Cells& cells,
                               const ldc::OctreeKey& key);

}  // namespace surfcast::point_tree
