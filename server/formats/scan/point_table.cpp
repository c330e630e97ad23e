#include "scan/point_table.h"

#include <cstring>
#include <utility>

namespace surfcast::scan {

void add_column(PointTable& table, surfel::ScalarValues values) {
  table.storage.push_back(std::move(values));
  std::visit(
      [&](const auto& stored) {
        table.columns.push_back({type_of(table.storage.back()), reinterpret_cast<const std::byte*>(stored.data()),
                                 sizeof(stored[0]), false});
      },
      table.storage.back());
}

PointTable pick_rows(const PointTable& table, std::span<const uint32_t> rows) {
  size_t bytes = 0;
  for (const Column& column : table.columns) bytes += size_of(column.type);
  PointTable picked;
  picked.rows = rows.size();
  picked.records.resize(rows.size() * bytes);
  size_t offset = 0;
  for (const Column& column : table.columns) {
    const size_t size = size_of(column.type);
    for (size_t i = 0; i < rows.size(); ++i) {
      std::memcpy(&picked.records[i * bytes + offset], column.first + rows[i] * column.stride, size);
    }
    const std::byte* first = rows.empty() ? nullptr : &picked.records[offset];
    picked.columns.push_back({column.type, first, bytes, column.swapped});
    offset += size;
  }
  return picked;
}

}  // namespace surfcast::scan
