#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file_folder.h"
#include "base/result.h"
#include "geometry/box.h"
#include "geometry/zone.h"
#include "scan/point_table.h"
#include "scan/row_source.h"
#include "surfel/grid.h"

namespace surfcast::scan {

/// Depth and place of a node.
using EptKey = std::array<uint32_t, 4>;

/// A dimension of the schema, as binary tiles store it.
struct EptDimension {
  std::string name;
  ScalarType type = ScalarType::kInt32;
  double scale = 1;
  double offset = 0;

  [[nodiscard]] bool scaled() const { return scale != 1 || offset != 0; }
};

enum class EptCoding { kLaz, kBinary, kZstandard };

/// What an ept.json states (EPT 1.0).
struct EptDescription {
  EptCoding coding = EptCoding::kLaz;
  geometry::Box cube;
  geometry::Box conforming;  ///< of the points; empty if it is not stated
  double span = 0;           ///< cells along the side of a node, of which each has a point at most; 0: not stated
  std::vector<EptDimension> schema;
  std::string crs;

  [[nodiscard]] size_t record_bytes() const;
};

/// Points of each node.
using EptNodes = std::map<EptKey, uint64_t>;

Result<EptDescription> parse_ept(std::span<const std::byte> bytes);

/// "2-1-0-3".
std::string ept_name(const EptKey& key);
/// The file of a node's points within the folder.
std::string ept_tile_name(const EptDescription& ept, const EptKey& key);

/// The nodes that may have points in the zone, those without points, too. Reads no page of the hierarchy whose nodes
/// all lie elsewhere; pages of one depth are announced together. kLimit if the pages have more than `most_bytes`.
Result<EptNodes> read_ept_nodes(const EptDescription& ept, const FileFolder& folder, const geometry::Zone& zone,
                                uint64_t most_bytes = std::numeric_limits<uint64_t>::max());

/// What all tiles have. `tile`: any of them. Errors of this and the next function do not name the tile.
struct EptColumns {
  std::vector<ColumnInfo> columns;
  std::optional<surfel::Grid> grid;  ///< of a tile
};
Result<EptColumns> ept_columns(const EptDescription& ept, std::span<const std::byte> tile);

/// The points of a tile, of which the hierarchy states so many.
Result<PointTable> ept_points(const EptDescription& ept, std::span<const ColumnInfo> columns,
                              std::span<const std::byte> tile, uint64_t count);

}  // namespace surfcast::scan
