#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "scan/json_access.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// A point tile of 3D Tiles (`pnts`, 3D Tiles 1.0): its tables, checked for their sizes.
struct PntsTile {
  Json features;
  std::span<const std::byte> feature_bytes;
  Json batches;
  std::span<const std::byte> batch_bytes;
  uint64_t points = 0;
};

/// Splits a file. `bytes` must outlive the tile.
Result<PntsTile> parse_pnts(std::span<const std::byte> bytes);

/// The columns of its points: positions, colours, normals, numbers of the batch table. Draco tiles are decoded for
/// them.
Result<std::vector<ColumnInfo>> pnts_columns(const PntsTile& tile, const DecodingLimit& limit);

/// The points in those columns, RTC_CENTER and then the transform applied. Refers to nothing else.
Result<PointTable> pnts_table(const PntsTile& tile, const glm::dmat4& transform, const DecodingLimit& limit);

/// The points of a tile alone, without a transform of a tileset. Z is up.
Result<std::unique_ptr<RowSource>> pnts_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

}  // namespace surfcast::scan
