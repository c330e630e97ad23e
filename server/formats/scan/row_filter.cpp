#include "scan/row_filter.h"

#include "scan/column_names.h"

namespace surfcast::scan {
namespace {

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

Result<RowFilter> RowFilter::make(const std::vector<ColumnInfo>& columns, const Selection& selection) {
  const Result<ColumnTriple> position = position_of(columns);
  if (!position) return fail(position);
  RowFilter filter;
  filter.selection_ = selection;
  filter.position_ = *position;
  for (const uint8_t wanted : selection.classes) filter.wanted_.set(wanted);
  if (selection.classes.empty()) return filter;
  filter.class_column_ = class_column(columns);
  if (!filter.class_column_) return fail(ErrorKind::kInvalidInput, "has no classification to choose points by");
  return filter;
}

std::vector<uint32_t> RowFilter::chosen(const PointTable& piece) const {
  std::vector<bool> in(piece.rows, true);
  for (size_t i = 0; i < piece.rows; ++i) in[i] = i % selection_.every == 0;
  if (!selection_.zone.everywhere()) keep_inside(piece, in);
  if (class_column_) keep_classes(piece.columns[*class_column_], in);
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < piece.rows; ++i) {
    if (in[i]) rows.push_back(i);
  }
  return rows;
}

void RowFilter::keep_inside(const PointTable& piece, std::vector<bool>& in) const {
  std::vector<glm::dvec3> positions(piece.rows);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_value(piece.columns[position_[static_cast<size_t>(axis)]], piece.rows,
                   [&](size_t i, auto value) { positions[i][axis] = static_cast<double>(value); });
  }
  for (size_t i = 0; i < piece.rows; ++i) in[i] = in[i] && geometry::contains(selection_.zone, positions[i]);
}

void RowFilter::keep_classes(const Column& column, std::vector<bool>& in) const {
  for_each_value(column, in.size(), [&](size_t i, auto value) {
    const auto number = static_cast<double>(value);
    in[i] = in[i] && number >= 0 && number < 256 && wanted_[static_cast<size_t>(number)];
  });
}

}  // namespace surfcast::scan
