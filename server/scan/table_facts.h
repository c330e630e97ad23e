#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "geometry/box.h"
#include "scan/column_roles.h"
#include "scan/point_table.h"

namespace surfcast::scan {

/// What is true of all values of a column.
struct ColumnFacts {
  bool integers = true;   ///< false with a NaN among them
  bool recorded = false;  ///< one is not zero
  double min = INFINITY;  ///< of those that are numbers
  double max = -INFINITY;

  template <typename T>
  void include(T value) {
    const auto v = static_cast<double>(value);
    if constexpr (std::is_floating_point_v<T>) integers = integers && std::trunc(v) == v;
    recorded = recorded || value != 0;
    if (v < min) min = v;
    if (v > max) max = v;
  }
  void include(const ColumnFacts& other);
};

/// Whether three columns side by side are unit vectors, as well as decimals state them, or zero, in every row.
struct UnitFacts {
  bool unit_or_zero = true;
  bool any = false;  ///< one is not zero
};

/// What has to be known of all rows before one of them can be turned into a point. Facts of pieces add up to the facts
/// of the whole.
struct TableFacts {
  uint64_t rows = 0;
  uint64_t announced = 0;
  geometry::Box bounds;  ///< of the positions whose coordinates are all finite
  std::vector<ColumnFacts> columns;
  std::vector<UnitFacts> units;  ///< of the columns from each one on; only where columns have no names
  bool any_normal = false;       ///< one of the normals has a direction
  uint8_t min_alpha = 255;       ///< of a packed colour
  uint8_t max_alpha = 0;

  void include(const TableFacts& other);
};

TableFacts find_facts(const PointTable& table, const ColumnRoles& roles, bool unnamed);

}  // namespace surfcast::scan
