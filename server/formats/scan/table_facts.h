#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "geometry/box.h"
#include "scan/column_roles.h"
#include "scan/point_table.h"

namespace surfcast::scan {

/// Aggregate properties of the values of a column.
struct ColumnFacts {
  bool integers = true;   ///< all values are integers; false if one is NaN
  bool recorded = false;  ///< at least one value is not zero
  double min = INFINITY;  ///< of the values that are not NaN
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

/// Properties of three adjacent columns: whether every row is zero or a unit vector, within the precision of decimals.
struct UnitFacts {
  bool unit_or_zero = true;
  bool any = false;  ///< at least one row is not zero
};

/// Properties of all rows that are needed before any row can be converted to a point. The facts of pieces can be
/// merged.
struct TableFacts {
  uint64_t rows = 0;
  uint64_t announced = 0;
  geometry::Box bounds;  ///< of the positions with finite coordinates
  std::vector<ColumnFacts> columns;
  std::vector<UnitFacts> units;  ///< of each column and the two after it; only if columns have no names
  bool any_normal = false;       ///< at least one normal is finite and not zero
  uint8_t min_alpha = 255;       ///< of the packed colour
  uint8_t max_alpha = 0;

  void include(const TableFacts& other);
};

TableFacts find_facts(const PointTable& table, const ColumnRoles& roles, bool unnamed);

}  // namespace surfcast::scan
