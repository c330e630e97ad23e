#include "scan/selected_rows.h"

#include <utility>
#include <vector>

#include "scan/row_filter.h"

namespace surfcast::scan {
namespace {

class SelectedRows : public RowSource {
 public:
  SelectedRows(std::unique_ptr<RowSource> rows, RowFilter filter, const Selection& selection)
      : rows_(std::move(rows)), filter_(std::move(filter)), traits_(rows_->traits()) {
    traits_.announced = 0;
    traits_.sampled = traits_.sampled || selection.every > 1;
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return rows_->columns(); }
  [[nodiscard]] size_t pieces() const override { return rows_->pieces(); }
  [[nodiscard]] uint64_t held_bytes() const override { return rows_->held_bytes(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const Result<PointTable> table = rows_->read(piece);
    if (!table) return fail(table);
    return pick_rows(*table, filter_.chosen(*table));
  }

 private:
  std::unique_ptr<RowSource> rows_;
  RowFilter filter_;
  RowTraits traits_;
};

}  // namespace

Result<std::unique_ptr<RowSource>> select_rows(std::unique_ptr<RowSource> rows, const Selection& selection) {
  if (selection.everything()) return rows;
  return RowFilter::make(rows->columns(), selection).map([&](RowFilter filter) -> std::unique_ptr<RowSource> {
    return std::make_unique<SelectedRows>(std::move(rows), std::move(filter), selection);
  });
}

}  // namespace surfcast::scan
