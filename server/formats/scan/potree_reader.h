#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/box.h"
#include "scan/potree_index.h"
#include "scan/row_source.h"
#include "scan/selection.h"
#include "surfel/grid.h"

namespace surfcast::scan {

/// Reads a Potree folder of version 1 (`cloud.js`; nodes as LAS, LAZ or BIN) or 2 (`metadata.json`; DEFAULT or BROTLI).
/// Of a selection with bounds only the nodes that meet them.
Result<std::unique_ptr<RowSource>> potree1_rows(const std::filesystem::path& cloud, const DecodingLimit& limit,
                                                const Selection& selection);
Result<std::unique_ptr<RowSource>> potree2_rows(const std::filesystem::path& metadata, const DecodingLimit& limit,
                                                const Selection& selection);

/// A Potree folder of version 2 whose nodes are read one by one.
struct Potree2Folder {
  geometry::Box cube;
  double spacing = 0;  ///< of the points of the root, as stated; 0: not stated
  surfel::Grid grid;   ///< of all positions
  std::vector<PotreeNode> nodes;
  std::vector<ColumnInfo> columns;
  /// The points of a node, whose bytes of octree.bin these are. They refer to nothing else than the table. Thread-safe.
  std::function<Result<PointTable>(const PotreeNode& node, std::span<const std::byte> bytes)> points;
};

/// Reads the description and the hierarchy.
Result<Potree2Folder> open_potree2(const std::filesystem::path& metadata);

}  // namespace surfcast::scan
