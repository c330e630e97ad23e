#include "scan/selected_rows.h"

#include <array>
#include <bitset>
#include <optional>
#include <utility>
#include <vector>

#include "scan/attribute_names.h"
#include "scan/column_roles.h"

namespace surfcast::scan {
namespace {

class SelectedRows : public RowSource {
 public:
  SelectedRows(std::unique_ptr<RowSource> rows, Selection selection, const ColumnTriple& position,
               std::optional<size_t> classes)
      : rows_(std::move(rows)),
        selection_(std::move(selection)),
        position_(position),
        class_column_(classes),
        traits_(rows_->traits()) {
    traits_.announced = 0;
    traits_.sampled = traits_.sampled || selection_.every > 1;
    for (const uint8_t wanted : selection_.classes) wanted_.set(wanted);
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return rows_->columns(); }
  [[nodiscard]] size_t pieces() const override { return rows_->pieces(); }
  [[nodiscard]] uint64_t held_bytes() const override { return rows_->held_bytes(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const Result<PointTable> table = rows_->read(piece);
    if (!table) return fail(table.error());
    return pick_rows(*table, chosen(*table));
  }

 private:
  [[nodiscard]] std::vector<uint32_t> chosen(const PointTable& table) const {
    std::vector<bool> in(table.rows, true);
    for (size_t i = 0; i < table.rows; ++i) in[i] = i % selection_.every == 0;
    if (selection_.bounds) keep_inside(table, in);
    if (class_column_) keep_classes(table.columns[*class_column_], in);
    std::vector<uint32_t> rows;
    for (uint32_t i = 0; i < table.rows; ++i) {
      if (in[i]) rows.push_back(i);
    }
    return rows;
  }

  void keep_inside(const PointTable& table, std::vector<bool>& in) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double low = selection_.bounds->min[axis];
      const double high = selection_.bounds->max[axis];
      for_each_value(table.columns[position_[static_cast<size_t>(axis)]], table.rows, [&](size_t i, auto value) {
        const auto number = static_cast<double>(value);
        in[i] = in[i] && number >= low && number <= high;
      });
    }
  }

  void keep_classes(const Column& column, std::vector<bool>& in) const {
    for_each_value(column, in.size(), [&](size_t i, auto value) {
      const auto number = static_cast<double>(value);
      in[i] = in[i] && number >= 0 && number < 256 && wanted_[static_cast<size_t>(number)];
    });
  }

  std::unique_ptr<RowSource> rows_;
  Selection selection_;
  ColumnTriple position_;
  std::optional<size_t> class_column_;
  std::bitset<256> wanted_;
  RowTraits traits_;
};

std::optional<size_t> class_column(const std::vector<ColumnInfo>& columns) {
  for (size_t i = 0; i < columns.size(); ++i) {
    if (canonical_attribute_name(columns[i].name) == "classification") return i;
  }
  return std::nullopt;
}

Result<ColumnTriple> position_of(const std::vector<ColumnInfo>& columns) {
  if (columns[0].name.empty()) return ColumnTriple{0, 1, 2};
  return assign_roles(columns, {}).map([](const ColumnRoles& roles) { return roles.position; });
}

}  // namespace

Result<std::unique_ptr<RowSource>> select_rows(std::unique_ptr<RowSource> rows, const Selection& selection) {
  if (selection.everything()) return rows;
  const Result<ColumnTriple> position = position_of(rows->columns());
  if (!position) return fail(position.error());
  std::optional<size_t> classes;
  if (!selection.classes.empty()) {
    classes = class_column(rows->columns());
    if (!classes) return fail(ErrorKind::kInvalidInput, "has no classification to choose points by");
  }
  return std::make_unique<SelectedRows>(std::move(rows), selection, *position, classes);
}

}  // namespace surfcast::scan
