#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/result.h"
#include "exporter/las_counts.h"
#include "exporter/record_spool.h"
#include "geometry/morton.h"
#include "ldc/octree_key.h"

namespace surfcast::exporter {

/// Takes the nodes of an octree of points, every child before its parent. Each point is in one node, and each node has
/// a point.
class NodeWriter {
 public:
  NodeWriter() = default;
  NodeWriter(const NodeWriter&) = delete;
  NodeWriter& operator=(const NodeWriter&) = delete;
  virtual ~NodeWriter() = default;

  /// `records`: of the points of the node.
  virtual Status take(const ldc::OctreeKey& key, std::vector<std::byte> records) = 0;
};

struct OctreeOptions {
  /// Cells with at most as many points, or 15, are not divided. Surfels of a scan in place are made of whole nodes,
  /// and small nodes have fewer points that are hidden (docs/in-place.md).
  uint64_t leaf_points = 12000;
  uint64_t memory = 1ULL << 30;   ///< bytes for points
  size_t page_entries = 1 << 15;  ///< most nodes of a page of the hierarchy, see make_pages
};

/// The deepest nodes. What is in one of them is a 2^-14 part of the cube wide.
inline constexpr int kDeepestNode = 14;

/// Divides point records of LAS among the nodes of an octree. The points in the cell of a node that are in it or in one
/// above are an even sample (even_sample.h, node_sample.h) of those that are in it or one of its children or above,
/// within the cell: at its faces they may be closer to those of its neighbours. Nodes whose cells have at most
/// `leaf_points` points, or points in one place alone, and those of depth kDeepestNode have no children. The nodes and
/// their order depend on the points alone: not on the order of these, on memory or on the number of threads.
///
/// Records are sorted in memory if a quarter of it holds them, and part by part otherwise, from a temporary file beside
/// the target. Sorting takes as much again and the keys of the points. A cell of depth kDeepestNode is always a part.
Status write_octree(RecordSpool& spool, const LasHead& head, const geometry::RootCube& cube,
                    const std::filesystem::path& target, const OctreeOptions& options, NodeWriter& writer);

}  // namespace surfcast::exporter
