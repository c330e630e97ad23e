#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.h"
#include "scan/column_roles.h"
#include "scan/point_table.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// Which rows of a table with known columns are in a selection.
class RowFilter {
 public:
  /// Fails if classes are selected and the columns have none, or if there are no positions.
  static Result<RowFilter> make(const std::vector<ColumnInfo>& columns, const Selection& selection);

  /// The rows in the selection, ascending.
  [[nodiscard]] std::vector<uint32_t> chosen(const PointTable& piece) const;

 private:
  void keep_inside(const PointTable& piece, std::vector<bool>& in) const;
  void keep_classes(const Column& column, std::vector<bool>& in) const;

  Selection selection_;
  ColumnTriple position_{};
  std::optional<size_t> class_column_;
  std::bitset<256> wanted_;
};

}  // namespace surfcast::scan
