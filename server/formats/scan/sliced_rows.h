#pragma once

#include <utility>
#include <vector>

#include "scan/row_source.h"

namespace surfcast::scan {

/// A complete table, in a mapped file or decoded in memory, that is read in pieces.
class SlicedRows : public RowSource {
 public:
  SlicedRows(RowTraits traits, std::vector<ColumnInfo> columns, PointTable table)
      : traits_(std::move(traits)), columns_(std::move(columns)), table_(std::move(table)) {}

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return (table_.rows + kPieceRows - 1) / kPieceRows; }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const size_t first = piece * kPieceRows;
    PointTable slice;
    slice.rows = std::min<size_t>(kPieceRows, table_.rows - first);
    slice.columns = table_.columns;
    for (Column& column : slice.columns) column.first += first * column.stride;
    return slice;
  }
  [[nodiscard]] uint64_t held_bytes() const override {
    uint64_t bytes = table_.records.size();
    for (const surfel::ScalarValues& values : table_.storage) {
      bytes += std::visit([](const auto& typed) { return typed.size() * sizeof(typed[0]); }, values);
    }
    return bytes;
  }

 private:
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
  PointTable table_;
};

}  // namespace surfcast::scan
