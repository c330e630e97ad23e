#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast::model {

/// The type of an attribute of a table. Wider components are not supported, because Draco would code them with symbol
/// tables as large as their range.
struct TableType {
  uint8_t bytes = 2;       ///< 1 or 2 per component
  uint8_t components = 1;  ///< coded together
  bool operator==(const TableType&) const = default;
};

/// An attribute of a table: unsigned integers; the components of a row are adjacent.
struct TableAttribute {
  TableType type;
  std::vector<uint16_t> values;

  [[nodiscard]] size_t rows() const { return values.size() / type.components; }
};

/// Packs attributes of equal length as a Draco point cloud. The rows keep their order.
std::vector<std::byte> encode_table(std::span<const TableAttribute> attributes);

/// Unpacks the first `wanted` attributes of a table, which must have `rows` rows and attributes of exactly these types.
/// The other attributes are not decoded, which saves time.
Result<std::vector<TableAttribute>> decode_table(std::span<const std::byte> bytes, std::span<const TableType> types,
                                                 uint32_t rows, size_t wanted);

}  // namespace surfcast::model
