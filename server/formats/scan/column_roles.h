#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/point_table.h"

namespace surfcast::scan {

using ColumnTriple = std::array<size_t, 3>;

/// More columns than any scan has. The limit bounds the time to make names unique, which is quadratic.
inline constexpr size_t kMaxColumns = 1024;

/// An error beyond that limit.
[[nodiscard]] Status check_column_count(uint64_t columns);

/// The roles of the columns of a table, as column indices.
struct ColumnRoles {
  struct Scalar {
    size_t column = 0;
    std::string name;
  };
  ColumnTriple position{};
  std::optional<ColumnTriple> normal;
  std::optional<size_t> radius;
  std::optional<ColumnTriple> color;
  std::optional<size_t> packed_color;  ///< 0xAARRGGBB, stored as an integer or (PCL) as the bits of a float
  bool packed_alpha = false;           ///< the first byte of packed_color may be an alpha
  std::vector<Scalar> scalars;         ///< all other columns, in file order
};

/// Assigns roles to columns by name: x y z; nx ny nz, normal_x ...; red green blue, r g b, diffuse_red ...; a packed
/// rgb; radius. Names are compared without case, underscores and a leading "scalar_". Every other column becomes a
/// scalar attribute, under its well-known name if it has one ("ReturnNumber" becomes "return_number"). A repeated name
/// gets a number appended. Columns marked in `absent` (empty, or one flag per column) are skipped. Fails without x, y
/// and z.
Result<ColumnRoles> assign_roles(std::span<const ColumnInfo> columns, const std::vector<bool>& absent);

[[nodiscard]] inline uint32_t packed_color_bits(const Column& column, size_t row) {
  return load<uint32_t>(column.first + row * column.stride, column.swapped);
}

}  // namespace surfcast::scan
