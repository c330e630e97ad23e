#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scan/scalar_type.h"

namespace surfcast::scan {

/// One named number of every point.
struct ColumnInfo {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  bool reserved = false;  ///< the format has room for it in any case: zero everywhere means that there is none

  bool operator==(const ColumnInfo&) const = default;
};

/// Values of a column, seen in place: value i is at `first + i * stride`.
struct Column {
  ScalarType type = ScalarType::kFloat32;
  const std::byte* first = nullptr;
  size_t stride = 0;
  bool swapped = false;  ///< stored in the other byte order
};

/// Some points of a file as columns of one length. Binary files are seen in place (the file must stay mapped); numbers
/// decoded from text are kept in `storage`, which the columns point into.
struct PointTable {
  size_t rows = 0;
  uint64_t announced = 0;  ///< rows that count lines within this part of a PTS file speak of
  std::vector<Column> columns;
  std::vector<surfel::ScalarValues> storage;
  std::vector<std::byte> records;  ///< decoded records that columns point into
};

/// Adds a column that holds `values`, of `table.rows` values.
void add_column(PointTable& table, surfel::ScalarValues values);

/// Calls `use(i, value)` with every value of the column in its own type.
template <typename Use>
void for_each_value(const Column& column, size_t rows, Use&& use) {
  with_type(column.type, [&](auto zero) {
    using T = decltype(zero);
    const std::byte* at = column.first;
    if (column.swapped) {
      for (size_t i = 0; i < rows; ++i, at += column.stride) use(i, load<T>(at, true));
    } else {
      for (size_t i = 0; i < rows; ++i, at += column.stride) use(i, load<T>(at));
    }
  });
}

}  // namespace surfcast::scan
