#include "builder/spooled_rows.h"

#include <algorithm>
#include <utility>

namespace surfcast::builder {
namespace {

class SpooledRows : public scan::RowSource {
 public:
  SpooledRows(SpoolFile file, std::vector<scan::ColumnInfo> columns, scan::RowTraits traits)
      : file_(std::move(file)), traits_(std::move(traits)), columns_(std::move(columns)) {
    for (const scan::ColumnInfo& column : columns_) record_ += scan::size_of(column.type);
  }

  [[nodiscard]] const scan::RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return (rows() + scan::kPieceRows - 1) / scan::kPieceRows; }
  [[nodiscard]] Result<scan::PointTable> read(size_t piece) const override;

 private:
  [[nodiscard]] uint64_t rows() const { return file_.size() / record_; }

  SpoolFile file_;
  scan::RowTraits traits_;
  std::vector<scan::ColumnInfo> columns_;
  size_t record_ = 0;
};

Result<scan::PointTable> SpooledRows::read(size_t piece) const {
  const uint64_t first = piece * scan::kPieceRows;
  scan::PointTable table;
  table.rows = static_cast<size_t>(std::min(scan::kPieceRows, rows() - first));
  table.records.resize(table.rows * record_);
  if (Status status = file_.read(first * record_, table.records); !status) return fail(status);
  const std::byte* at = table.records.data();
  for (const scan::ColumnInfo& column : columns_) {
    table.columns.push_back({column.type, at, record_, false});
    at += scan::size_of(column.type);
  }
  return table;
}

}  // namespace

std::unique_ptr<scan::RowSource> spooled_rows(SpoolFile file, std::vector<scan::ColumnInfo> columns,
                                              scan::RowTraits traits) {
  return std::make_unique<SpooledRows>(std::move(file), std::move(columns), std::move(traits));
}

}  // namespace surfcast::builder
