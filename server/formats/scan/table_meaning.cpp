#include "scan/table_meaning.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "scan/column_names.h"
#include "scan/up_axis.h"
#include "surfel/opacity.h"

namespace surfcast::scan {
namespace {

// ---- deciding

std::vector<bool> absent_columns(std::span<const ColumnInfo> columns, const TableFacts& facts) {
  std::vector<bool> absent(columns.size());
  for (size_t i = 0; i < columns.size(); ++i) absent[i] = columns[i].reserved && !facts.columns[i].recorded;
  return absent;
}

/// A colour of three reserved columns exists if one of them has a value.
void keep_colors_together(std::span<const ColumnInfo> columns, std::vector<bool>& absent) {
  std::vector<size_t> channels;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].reserved && (columns[i].name == "red" || columns[i].name == "green" || columns[i].name == "blue")) {
      channels.push_back(i);
    }
  }
  const bool any = std::any_of(channels.begin(), channels.end(), [&absent](size_t i) { return !absent[i]; });
  for (const size_t i : channels) absent[i] = !any;
}

std::vector<ColumnInfo> named_columns(const RowSource& rows, const TableFacts& facts) {
  std::vector<ColumnInfo> columns = rows.columns();
  if (!columns[0].name.empty()) return columns;
  const std::vector<std::string> names = guess_column_names(facts, rows.traits().counted);
  for (size_t i = 0; i < columns.size(); ++i) columns[i].name = names[i];
  return columns;
}

template <typename T>
bool holds(const ColumnFacts& facts) {
  using Limits = std::numeric_limits<T>;
  return facts.integers && facts.min >= Limits::min() && facts.max <= Limits::max();
}

/// The smallest type that holds all the doubles. An integer type (8, 16 or 32 bits, unsigned if none is negative) if
/// all are integers.
ScalarType narrow_type(const ColumnFacts& facts) {
  if (holds<uint8_t>(facts)) return ScalarType::kUint8;
  if (holds<int8_t>(facts)) return ScalarType::kInt8;
  if (holds<uint16_t>(facts)) return ScalarType::kUint16;
  if (holds<int16_t>(facts)) return ScalarType::kInt16;
  if (holds<uint32_t>(facts)) return ScalarType::kUint32;
  if (holds<int32_t>(facts)) return ScalarType::kInt32;
  return ScalarType::kFloat64;
}

/// An opacity is a share of the largest number of its type, so the type follows the values: 1 or 255 is opaque,
/// whatever numbers a file has.
ScalarType opacity_type(ScalarType type, const ColumnFacts& facts, bool from_text) {
  if (facts.max <= 1) return is_floating(type) ? type : ScalarType::kFloat32;
  return is_floating(type) && !from_text ? type : narrow_type(facts);
}

void decide_colors(std::span<const ColumnInfo> columns, const TableFacts& facts, TableMeaning& meaning) {
  if (meaning.roles.packed_color) meaning.schema.color_bits = 8;
  if (!meaning.roles.color) return;
  const ColumnTriple& channels = *meaning.roles.color;
  const ScalarType type = columns[channels[0]].type;
  double largest = 0;
  for (const size_t i : channels) largest = std::max(largest, facts.columns[i].max);
  const bool fractions = is_floating(type) && largest <= 1;
  const bool bytes = !is_floating(type) && size_of(type) == 1;
  meaning.schema.color_bits = !fractions && (bytes || largest <= 255) ? 8 : 16;
  meaning.color_factor = fractions ? 65535 : 1;
}

void decide_scalars(std::span<const ColumnInfo> columns, const RowSource& rows, const TableFacts& facts,
                    TableMeaning& meaning) {
  // A constant alpha carries no information.
  meaning.alpha = meaning.roles.packed_alpha && facts.min_alpha != facts.max_alpha;
  if (meaning.alpha) meaning.schema.scalars.push_back({"alpha", ScalarType::kUint8});
  for (const auto& [column, name] : meaning.roles.scalars) {
    const ScalarType type = columns[column].type;
    const bool narrow = rows.traits().from_text && type == ScalarType::kFloat64;
    const ScalarType stored = name == surfel::kOpacityAttribute
                                  ? opacity_type(type, facts.columns[column], rows.traits().from_text)
                                  : (narrow ? narrow_type(facts.columns[column]) : type);
    meaning.schema.scalars.push_back({name, stored});
  }
}

/// Some writers store a scanner position at the origin by default. It is ignored if it is farther from all points than
/// the diagonal of their bounds.
bool is_default_sensor(const glm::dvec3& sensor, const geometry::Box& box) {
  if (sensor != glm::dvec3(0)) return false;
  const glm::dvec3 nearest = glm::clamp(glm::dvec3(0), box.min, box.max);
  return box.empty() || glm::length(nearest) > box.diagonal();
}

// ---- converting

template <typename Vector>
std::vector<Vector> read_vectors(const PointTable& table, const ColumnTriple& triple) {
  std::vector<Vector> vectors(table.rows);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_value(table.columns[triple[static_cast<size_t>(axis)]], table.rows,
                   [&](size_t i, auto value) { vectors[i][axis] = static_cast<typename Vector::value_type>(value); });
  }
  return vectors;
}

std::vector<glm::u16vec3> read_colors(const PointTable& table, const ColumnTriple& triple, int bits, double factor) {
  const double top = bits == 8 ? 255 : 65535;
  std::vector<glm::u16vec3> colors(table.rows);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_value(table.columns[triple[static_cast<size_t>(axis)]], table.rows, [&](size_t i, auto value) {
      const double scaled = static_cast<double>(value) * factor + 0.5;
      // The comparison maps NaN to 0.
      colors[i][axis] = static_cast<uint16_t>(scaled > 0 ? std::min(scaled, top) : 0.0);
    });
  }
  return colors;
}

void read_packed_colors(const PointTable& table, const TableMeaning& meaning, ScanPoints& points) {
  const Column& column = table.columns[*meaning.roles.packed_color];
  points.colors = surfel::ColorAttribute{8, std::vector<glm::u16vec3>(table.rows)};
  std::vector<uint8_t> alpha(meaning.alpha ? table.rows : 0);
  for (size_t i = 0; i < table.rows; ++i) {
    const uint32_t bits = packed_color_bits(column, i);
    points.colors->values[i] = {(bits >> 16) & 255, (bits >> 8) & 255, bits & 255};
    if (meaning.alpha) alpha[i] = static_cast<uint8_t>(bits >> 24);
  }
  if (meaning.alpha) points.scalars.push_back({"alpha", std::move(alpha)});
}

surfel::ScalarValues read_scalars(const Column& column, size_t rows, ScalarType type) {
  return with_type(type, [&](auto zero) {
    using T = decltype(zero);
    std::vector<T> values(rows);
    // NOLINTNEXTLINE(bugprone-signed-char-misuse): numbers of 8 bits, not characters
    for_each_value(column, rows, [&](size_t i, auto value) { values[i] = static_cast<T>(value); });
    return surfel::ScalarValues(std::move(values));
  });
}

}  // namespace

Result<TableMeaning> decide_meaning(const RowSource& rows, const TableFacts& facts) {
  const RowTraits& traits = rows.traits();
  if (facts.rows == 0) return fail(ErrorKind::kInvalidInput, "has no points");
  const std::vector<ColumnInfo> columns = named_columns(rows, facts);
  std::vector<bool> absent = absent_columns(columns, facts);
  keep_colors_together(columns, absent);
  Result<ColumnRoles> roles = assign_roles(columns, absent);
  if (!roles) return fail(roles);
  if (traits.sampled) roles->radius.reset();
  TableMeaning meaning;
  meaning.roles = std::move(*roles);
  meaning.schema.grid = traits.grid;
  meaning.schema.surface_step = traits.surface_step;
  meaning.schema.exact_radii = traits.exact_radii && !traits.sampled;
  meaning.schema.two_sided = traits.two_sided;
  meaning.schema.crs = traits.crs;
  meaning.schema.notes = traits.notes;
  meaning.schema.normals = meaning.roles.normal && (rows.columns()[0].name.empty() || facts.any_normal);
  meaning.schema.radii = meaning.roles.radius.has_value();
  decide_colors(columns, facts, meaning);
  decide_scalars(columns, rows, facts, meaning);
  if (traits.sensor && !is_default_sensor(*traits.sensor, facts.bounds)) meaning.schema.sensor = traits.sensor;
  meaning.schema.z_up =
      traits.z_up && (!traits.may_be_graphics || looks_like_survey(meaning.schema.scalars, facts.bounds));
  return meaning;
}

ScanPoints points_of(const PointTable& table, const TableMeaning& meaning) {
  const ColumnRoles& roles = meaning.roles;
  ScanPoints points;
  points.positions = read_vectors<glm::dvec3>(table, roles.position);
  if (meaning.schema.normals) points.normals = read_vectors<glm::vec3>(table, *roles.normal);
  if (roles.radius) {
    points.radii.resize(table.rows);
    for_each_value(table.columns[*roles.radius], table.rows,
                   [&](size_t i, auto value) { points.radii[i] = static_cast<float>(value); });
  }
  if (roles.color) {
    const int bits = meaning.schema.color_bits;
    points.colors = surfel::ColorAttribute{bits, read_colors(table, *roles.color, bits, meaning.color_factor)};
  } else if (roles.packed_color) {
    read_packed_colors(table, meaning, points);
  }
  for (const auto& [column, name] : roles.scalars) {
    const ScalarType type = meaning.schema.scalars[points.scalars.size()].type;
    points.scalars.push_back({name, read_scalars(table.columns[column], table.rows, type)});
  }
  return points;
}

}  // namespace surfcast::scan
