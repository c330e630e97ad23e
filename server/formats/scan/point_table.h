#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scan/scalar_type.h"

namespace surfcast::scan {

/// A named column of numbers, one for each point.
struct ColumnInfo {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  bool reserved = false;  ///< part of every file of the format: zero everywhere means absent

  bool operator==(const ColumnInfo&) const = default;
};

/// The values of a column in place: value i is at `first + i * stride`.
struct Column {
  ScalarType type = ScalarType::kFloat32;
  const std::byte* first = nullptr;
  size_t stride = 0;
  bool swapped = false;  ///< stored in the opposite byte order
};

/// Some points of a file, as columns of equal length. The columns of binary files point into the file, which must stay
/// mapped. Numbers decoded from text are kept in `storage`, into which the columns point.
struct PointTable {
  size_t rows = 0;
  uint64_t announced = 0;  ///< rows announced by count lines within this part of a PTS file
  std::vector<Column> columns;
  std::vector<surfel::ScalarValues> storage;
  std::vector<std::byte> records;  ///< decoded records into which columns point
  /// Of a table that is LAS point records, unselected: the first of them.
  const std::byte* las_records = nullptr;
};

/// Adds a column with `table.rows` values.
void add_column(PointTable& table, surfel::ScalarValues values);

/// These rows of the table, packed. They do not refer to `table`.
PointTable pick_rows(const PointTable& table, std::span<const uint32_t> rows);

/// Calls `use(i, value)` for every value of the column, in its own type.
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
