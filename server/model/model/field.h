#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast::model {

/// One integer per surfel of a block.
using Column = std::vector<uint64_t>;

/// Columns that are coded together because they have similar statistics (the three axes of positions).
using Field = std::vector<Column>;

/// How a column is reduced to few bits: value = base + stride * stored.
struct ColumnPacking {
  uint64_t base = 0;     ///< the smallest value
  uint64_t stride = 1;   ///< greatest common divisor of the differences to `base`
  uint64_t largest = 0;  ///< largest stored integer
};

ColumnPacking choose_packing(const Column& column);

/// Writes fields of equal length: the width and the packings of each field, then the stored integers, divided into
/// pieces of at most 16 bits, as one Draco point cloud. Without a Draco point cloud if every column is constant.
std::vector<std::byte> encode_fields(std::span<const Field> fields);

/// Reads the first `wanted` fields. `columns` is the number of columns of each field in `bytes`, `rows` their length.
/// Fails if the bytes hold anything else.
Result<std::vector<Field>> decode_fields(std::span<const std::byte> bytes, std::span<const size_t> columns,
                                         uint32_t rows, size_t wanted);

}  // namespace surfcast::model
