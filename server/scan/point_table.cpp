#include "scan/point_table.h"

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

}  // namespace surfcast::scan
