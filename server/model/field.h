#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast::model {

/// One integer per surfel of a block.
using Column = std::vector<uint64_t>;

/// Columns that are coded together because they behave alike (the three axes of positions).
using Field = std::vector<Column>;

/// How a column is brought down to few bits: value = base + stride * stored.
struct ColumnPacking {
  uint64_t base = 0;     ///< the smallest value
  uint64_t stride = 1;   ///< the largest common divisor of what lies above
  uint64_t largest = 0;  ///< stored integer
};

ColumnPacking choose_packing(const Column& column);

/// Writes fields of one length: for each its width and packings, then the stored integers, cut into pieces of at most
/// 16 bits, as one Draco point cloud (none when every column is constant).
std::vector<std::byte> encode_fields(std::span<const Field> fields);

/// Reads the first `wanted` fields of bytes that hold fields of that many columns each, with `rows` rows. Fails on
/// bytes that do not hold just that.
Result<std::vector<Field>> decode_fields(std::span<const std::byte> bytes, std::span<const size_t> columns,
                                         uint32_t rows, size_t wanted);

}  // namespace surfcast::model
