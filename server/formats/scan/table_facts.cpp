#include "scan/table_facts.h"

#include <algorithm>

#include "scan/unit_normal.h"

namespace surfcast::scan {
namespace {

ColumnFacts facts_of(const Column& column, size_t rows) {
  ColumnFacts facts;
  for_each_value(column, rows, [&facts](size_t, auto value) { facts.include(value); });
  return facts;
}

double value_at(const Column& column, size_t row) {
  return with_type(column.type, [&](auto zero) {
    return static_cast<double>(load<decltype(zero)>(column.first + row * column.stride, column.swapped));
  });
}

UnitFacts unit_facts(const PointTable& table, size_t column) {
  UnitFacts facts;
  for (size_t row = 0; row < table.rows && facts.unit_or_zero; ++row) {
    double squared = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double n = value_at(table.columns[column + axis], row);
      squared += n * n;
    }
    if (squared == 0) continue;
    facts.any = true;
    facts.unit_or_zero = std::abs(squared - 1) < 0.02;
  }
  return facts;
}

geometry::Box bounds_of(const PointTable& table, const ColumnTriple& position) {
  std::vector<glm::dvec3> points(table.rows);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_value(table.columns[position[static_cast<size_t>(axis)]], table.rows,
                   [&](size_t i, auto value) { points[i][axis] = static_cast<double>(value); });
  }
  geometry::Box box;
  for (const glm::dvec3& p : points) {
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) box.include(p);
  }
  return box;
}

bool has_normal(const PointTable& table, const ColumnTriple& normal) {
  for (size_t row = 0; row < table.rows; ++row) {
    glm::vec3 n;
    for (int axis = 0; axis < 3; ++axis) {
      n[axis] = static_cast<float>(value_at(table.columns[normal[static_cast<size_t>(axis)]], row));
    }
    if (unit_or_zero(n) != glm::vec3(0)) return true;
  }
  return false;
}

}  // namespace

void ColumnFacts::include(const ColumnFacts& other) {
  integers = integers && other.integers;
  recorded = recorded || other.recorded;
  min = std::min(min, other.min);
  max = std::max(max, other.max);
}

void TableFacts::include(const TableFacts& other) {
  rows += other.rows;
  announced += other.announced;
  bounds.include(other.bounds);
  columns.resize(other.columns.size());
  for (size_t i = 0; i < columns.size(); ++i) columns[i].include(other.columns[i]);
  units.resize(other.units.size());
  for (size_t i = 0; i < units.size(); ++i) {
    units[i].unit_or_zero = units[i].unit_or_zero && other.units[i].unit_or_zero;
    units[i].any = units[i].any || other.units[i].any;
  }
  any_normal = any_normal || other.any_normal;
  min_alpha = std::min(min_alpha, other.min_alpha);
  max_alpha = std::max(max_alpha, other.max_alpha);
}

TableFacts find_facts(const PointTable& table, const ColumnRoles& roles, bool unnamed) {
  TableFacts facts;
  facts.rows = table.rows;
  facts.announced = table.announced;
  facts.bounds = bounds_of(table, roles.position);
  for (const Column& column : table.columns) facts.columns.push_back(facts_of(column, table.rows));
  for (size_t i = 0; unnamed && i + 2 < table.columns.size(); ++i) facts.units.push_back(unit_facts(table, i));
  if (roles.normal) facts.any_normal = has_normal(table, *roles.normal);
  if (roles.packed_color) {
    const Column& packed = table.columns[*roles.packed_color];
    for (size_t i = 0; i < table.rows; ++i) {
      const auto alpha = static_cast<uint8_t>(packed_color_bits(packed, i) >> 24);
      facts.min_alpha = std::min(facts.min_alpha, alpha);
      facts.max_alpha = std::max(facts.max_alpha, alpha);
    }
  }
  return facts;
}

}  // namespace surfcast::scan
