#pragma once

#include <optional>
#include <string>
#include <vector>

namespace surfcast::ellipsoid {

/// How a table states the shape of an ellipsoid, as indices of columns.
struct ShapeRoles {
  std::vector<size_t> semi_axes;   ///< three, or none
  std::vector<size_t> quaternion;  ///< w x y z, or none
  std::vector<size_t> matrix;      ///< nine, row by row; the columns are the axes; or none
  std::vector<size_t> tensor;      ///< xx xy xz yy yz zz, instead of all others; or none

  [[nodiscard]] std::vector<size_t> all() const;
  [[nodiscard]] bool rotated() const { return !quaternion.empty() || !matrix.empty(); }
};

/// The columns of the shape by their names, without case, underscores and spaces: semi-axes a b c, rx ry rz,
/// semi_axis_1 2 3 (or 0 1 2, a b c, x y z), radius_x y z; a rotation qw qx qy qz, rot_w x y z, rot_0 1 2 3 (w first),
/// or r00 to r22; or a tensor xx xy xz yy yz zz, also with a leading t or d. None without semi-axes or a tensor.
[[nodiscard]] std::optional<ShapeRoles> shape_roles(const std::vector<std::string>& names);

}  // namespace surfcast::ellipsoid
