#pragma once

#include <cstdint>
#include <functional>
#include <glm/mat4x4.hpp>
#include <memory>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {

/// The points of a tile of 3D Tiles: pnts, glTF, or glTF in b3dm.
struct TileContent {
  std::vector<ColumnInfo> columns;  ///< none without a point
  uint64_t points = 0;
  bool others = false;  ///< it has triangles or lines, which are left out
  /// All points in those columns in the frame of the tileset; refers to nothing else. `transform`: of the tile.
  std::function<Result<PointTable>(const glm::dmat4& transform)> table;
};

/// Opens a content, which is named in errors. `file` must outlive it.
Result<TileContent> open_tile_content(const TileFile& file, const DecodingLimit& limit);

}  // namespace surfcast::scan
