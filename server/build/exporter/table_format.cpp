#include "exporter/table_format.h"

#include <array>
#include <charconv>
#include <cstring>
#include <type_traits>
#include <variant>

namespace surfcast::exporter {
namespace {

using scan::ScalarType;

/// The components of vectors of three.
template <typename T>
void add_vectors(scan::PointTable& table, ScalarType type, const std::vector<glm::vec<3, T>>& vectors) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto* first = reinterpret_cast<const std::byte*>(vectors.data()) + axis * sizeof(T);
    table.columns.push_back({type, first, sizeof(vectors[0]), false});
  }
}

/// Colours of 8 bits are kept in 16, of which the lower byte comes first.
ScalarType color_type(const scan::ScanSchema& schema) {
  return schema.color_bits == 8 ? ScalarType::kUint8 : ScalarType::kUint16;
}

template <typename T>
void store_value(std::byte* at, T value, bool wide_integers) {
  if (std::is_integral_v<T> && sizeof(T) == 8 && !wide_integers) {
    const auto number = static_cast<double>(value);
    std::memcpy(at, &number, sizeof(number));
  } else {
    std::memcpy(at, &value, sizeof(value));
  }
}

}  // namespace

std::vector<scan::ColumnInfo> columns_of(const scan::ScanSchema& schema) {
  std::vector<scan::ColumnInfo> columns;
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, ScalarType::kFloat64, false});
  if (schema.normals)
    for (const char* axis : {"nx", "ny", "nz"}) columns.push_back({axis, ScalarType::kFloat32, false});
  if (schema.radii) columns.push_back({"radius", ScalarType::kFloat32, false});
  if (schema.color_bits != 0)
    for (const char* name : {"red", "green", "blue"}) columns.push_back({name, color_type(schema), false});
  for (const scan::ScalarField& field : schema.scalars) columns.push_back({field.name, field.type, false});
  return columns;
}

scan::PointTable table_of(const scan::ScanPoints& points, const scan::ScanSchema& schema) {
  scan::PointTable table;
  table.rows = points.size();
  add_vectors(table, ScalarType::kFloat64, points.positions);
  if (schema.normals) add_vectors(table, ScalarType::kFloat32, points.normals);
  if (schema.radii) {
    table.columns.push_back(
        {ScalarType::kFloat32, reinterpret_cast<const std::byte*>(points.radii.data()), sizeof(float), false});
  }
  if (schema.color_bits != 0) add_vectors(table, color_type(schema), points.colors->values);
  for (const surfel::ScalarAttribute& scalar : points.scalars) {
    std::visit(
        [&](const auto& values) {
          const auto* first = reinterpret_cast<const std::byte*>(values.data());
          table.columns.push_back({scan::type_of(scalar.values), first, sizeof(values[0]), false});
        },
        scalar.values);
  }
  return table;
}

std::vector<std::byte> packed_rows(const scan::PointTable& table, bool wide_integers) {
  static_assert(sizeof(double) == sizeof(uint64_t));
  size_t length = 0;
  for (const scan::Column& column : table.columns) length += scan::size_of(column.type);
  std::vector<std::byte> rows(table.rows * length);
  size_t offset = 0;
  for (const scan::Column& column : table.columns) {
    scan::for_each_value(column, table.rows,
                         [&](size_t i, auto value) { store_value(&rows[i * length + offset], value, wide_integers); });
    offset += scan::size_of(column.type);
  }
  return rows;
}

std::string shortest(double number) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr};
}

}  // namespace surfcast::exporter
