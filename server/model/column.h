#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast {

/// One integer per surfel of a block.
using Column = std::vector<uint64_t>;

/// How a column is brought down to few bits: value = base + stride * stored, with `stored` in `bytes` bytes.
struct ColumnPacking {
  uint64_t base = 0;
  uint64_t stride = 1;
  uint8_t bytes = 0;  ///< 0 (all values are the base), 1, 2, 4 or 8
};

/// The smallest base, the largest stride and the fewest bytes that give every value of the column back.
ColumnPacking choose_packing(const Column& column);

/// Writes columns of one length: their packings, then the stored integers as one Draco point cloud (none when every
/// column is constant). Draco may reorder the rows; a row stays together.
std::vector<std::byte> encode_columns(std::span<const Column> columns);

/// Reads `count` columns of `rows` rows. Fails on bytes that do not hold just that.
Result<std::vector<Column>> decode_columns(std::span<const std::byte> bytes, size_t count, uint32_t rows);

}  // namespace surfcast
