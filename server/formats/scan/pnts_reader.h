#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "scan/json_access.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The tables of a tile of 3D Tiles 1.0, checked for their sizes, and what lies behind them.
struct TileTables {
  Json features;
  std::span<const std::byte> feature_bytes;
  Json batches;
  std::span<const std::byte> batch_bytes;
  std::span<const std::byte> body;
};

/// Splits a file of any kind that begins with both tables. `bytes` must outlive the tables.
Result<TileTables> split_tile(std::span<const std::byte> bytes);
/// What positions are relative to: RTC_CENTER, or the origin.
glm::dvec3 centre_of(const TileTables& tables);

/// A point tile (`pnts`).
struct PntsTile : TileTables {
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
