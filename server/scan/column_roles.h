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

/// Which columns of a table hold what, as indices.
struct ColumnRoles {
  struct Scalar {
    size_t column = 0;
    std::string name;
  };
  ColumnTriple position{};
  std::optional<ColumnTriple> normal;
  std::optional<size_t> radius;
  std::optional<ColumnTriple> color;
  std::optional<size_t> packed_color;  ///< 0xAARRGGBB, whether the column calls it an integer or (PCL) a float
  bool packed_alpha = false;           ///< and its first byte may be an alpha
  std::vector<Scalar> scalars;         ///< every other column, in the order of the file
};

/// Gives columns their meaning by name: x y z; nx ny nz or normal_x ...; red green blue, r g b, diffuse_red ... or a
/// packed rgb; radius. Names are compared without case, underscores and a leading "scalar_". Every other column is a
/// scalar attribute under its well-known name where it has one ("ReturnNumber" becomes "return_number"); a second one
/// of a name gets a number behind it. Columns that are `absent` (none or one flag each) are passed over. Fails without
/// x, y and z.
Result<ColumnRoles> assign_roles(std::span<const ColumnInfo> columns, const std::vector<bool>& absent);

[[nodiscard]] inline uint32_t packed_color_bits(const Column& column, size_t row) {
  return load<uint32_t>(column.first + row * column.stride, column.swapped);
}

}  // namespace surfcast::scan
