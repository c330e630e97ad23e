#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast {

/// A column of unsigned integers of 1, 2 or 4 bytes.
struct TableColumn {
  uint8_t bytes = 4;
  std::vector<uint32_t> values;
};

/// Packs columns of one length as a Draco point cloud, each column one attribute. Rows may come back in another order.
std::vector<std::byte> encode_table(std::span<const TableColumn> columns);

/// Unpacks a table that must have `rows` rows and columns of just these widths.
Result<std::vector<TableColumn>> decode_table(std::span<const std::byte> bytes, std::span<const uint8_t> widths,
                                              uint32_t rows);

}  // namespace surfcast
