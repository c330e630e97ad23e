#include "scan/point_table.h"

#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "scan/attribute_names.h"
#include "scan/text_tokens.h"

namespace surfcast {
namespace {

/// More than any scan has; naming columns apart takes time quadratic in their number.
constexpr size_t kMostColumns = 1024;

/// Columns by canonical name; the second column of a name keeps a name of its own.
using NamedColumns = std::map<std::string, const Column*>;
using Triple = std::array<const Column*, 3>;

/// Calls `use(i, value)` with every value of the column in its own type.
template <typename Use>
void for_each_value(const Column& column, size_t rows, Use&& use) {
  with_type(column.type, [&](auto zero) {
    using T = decltype(zero);
    const std::byte* at = column.first;
    for (size_t i = 0; i < rows; ++i, at += column.stride) use(i, load<T>(at, column.swapped));
  });
}

std::string unused_name(const NamedColumns& taken, const std::string& wanted) {
  std::string name = wanted;
  for (int suffix = 2; taken.contains(name); ++suffix) name = wanted + "_" + std::to_string(suffix);
  return name;
}

NamedColumns name_columns(const PointTable& table) {
  NamedColumns named;
  for (const Column& column : table.columns) {
    // Names end up in messages and JSON, which take no arbitrary bytes.
    const std::string given = printable(column.name);
    std::string name = canonical_attribute_name(given);
    if (named.contains(name)) name = unused_name(named, given);
    named.emplace(std::move(name), &column);
  }
  return named;
}

/// Takes three columns out, when all three are there.
std::optional<Triple> take_triple(NamedColumns& named, const char* a, const char* b, const char* c) {
  const auto ia = named.find(a);
  const auto ib = named.find(b);
  const auto ic = named.find(c);
  if (ia == named.end() || ib == named.end() || ic == named.end()) return std::nullopt;
  const Triple triple = {ia->second, ib->second, ic->second};
  named.erase(ia);
  named.erase(ib);
  named.erase(ic);
  return triple;
}

const Column* take(NamedColumns& named, const char* name) {
  const auto it = named.find(name);
  if (it == named.end()) return nullptr;
  const Column* column = it->second;
  named.erase(it);
  return column;
}

template <typename Vector>
std::vector<Vector> read_vectors(const Triple& triple, size_t rows) {
  std::vector<Vector> vectors(rows);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_value(*triple[static_cast<size_t>(axis)], rows,
                   [&](size_t i, auto value) { vectors[i][axis] = static_cast<typename Vector::value_type>(value); });
  }
  return vectors;
}

double largest_value(const Triple& triple, size_t rows) {
  double largest = 0;
  for (const Column* column : triple) {
    for_each_value(*column, rows, [&](size_t, auto value) {
      const auto v = static_cast<double>(value);
      if (v > largest) largest = v;
    });
  }
  return largest;
}

/// How stored numbers become colours: `value * factor`, rounded and held to what `bits` can say.
struct ColorScale {
  int bits = 8;
  double factor = 1;
};

ColorScale color_scale(const Triple& triple, size_t rows) {
  const bool floating = is_floating(triple[0]->type);
  if (!floating && size_of(triple[0]->type) == 1) return {8, 1};
  const double largest = largest_value(triple, rows);
  if (floating && largest <= 1) return {16, 65535};
  return {largest <= 255 ? 8 : 16, 1};
}

ColorAttribute read_colors(const Triple& triple, size_t rows) {
  const auto [bits, factor] = color_scale(triple, rows);
  const double top = bits == 8 ? 255 : 65535;
  ColorAttribute colors{bits, std::vector<glm::u16vec3>(rows)};
  for (int axis = 0; axis < 3; ++axis) {
    for_each_value(*triple[static_cast<size_t>(axis)], rows, [&, factor = factor](size_t i, auto value) {
      const double scaled = static_cast<double>(value) * factor + 0.5;
      // Written so that NaN becomes 0.
      colors.values[i][axis] = static_cast<uint16_t>(scaled > 0 ? std::min(scaled, top) : 0.0);
    });
  }
  return colors;
}

/// The four bytes of a packed colour, 0xAARRGGBB whether the column calls them an integer or (PCL) a float.
uint32_t packed_bits(const std::byte* at, const Column& column) {
  return load<uint32_t>(at, column.swapped);
}

bool is_packed(const Column& column) {
  return size_of(column.type) == sizeof(uint32_t);
}

ColorAttribute read_packed_colors(const Column& column, size_t rows) {
  ColorAttribute colors{8, std::vector<glm::u16vec3>(rows)};
  for (size_t i = 0; i < rows; ++i) {
    const uint32_t bits = packed_bits(column.first + i * column.stride, column);
    colors.values[i] = {(bits >> 16) & 255, (bits >> 8) & 255, bits & 255};
  }
  return colors;
}

/// The alpha of an rgba column, unless it is the same everywhere and so says nothing.
std::optional<ScalarAttribute> read_packed_alpha(const Column& column, size_t rows) {
  std::vector<uint8_t> alpha(rows);
  for (size_t i = 0; i < rows; ++i) {
    alpha[i] = static_cast<uint8_t>(packed_bits(column.first + i * column.stride, column) >> 24);
  }
  const bool varies = std::any_of(alpha.begin(), alpha.end(), [&](uint8_t a) { return a != alpha[0]; });
  if (!varies) return std::nullopt;
  return ScalarAttribute{"alpha", std::move(alpha)};
}

void take_colors(NamedColumns& named, size_t rows, ScanPoints& points) {
  if (const auto rgb = take_triple(named, "red", "green", "blue")) {
    points.colors = read_colors(*rgb, rows);
    return;
  }
  for (const char* name : {"rgb", "rgba"}) {
    const auto it = named.find(name);
    if (it == named.end() || !is_packed(*it->second)) continue;
    const Column& column = *take(named, name);
    points.colors = read_packed_colors(column, rows);
    if (column.name.size() == 4 && !named.contains("alpha")) {
      if (auto alpha = read_packed_alpha(column, rows)) points.scalars.push_back(std::move(*alpha));
    }
    return;
  }
}

ScalarValues copy_values(const Column& column, size_t rows) {
  return with_type(column.type, [&](auto zero) {
    std::vector<decltype(zero)> values(rows);
    const std::byte* at = column.first;
    for (size_t i = 0; i < rows; ++i, at += column.stride) values[i] = load<decltype(zero)>(at, column.swapped);
    return ScalarValues(std::move(values));
  });
}

/// What is left becomes scalar attributes, in the order of the file.
void take_scalars(const NamedColumns& named, const PointTable& table, ScanPoints& points) {
  for (const Column& column : table.columns) {
    for (const auto& [name, left] : named) {
      if (left == &column) points.scalars.push_back({name, copy_values(column, table.rows)});
    }
  }
}

}  // namespace

void add_column(PointTable& table, std::string name, ScalarValues values) {
  table.storage.push_back(std::move(values));
  std::visit(
      [&](const auto& stored) {
        table.columns.push_back({std::move(name), type_of(table.storage.back()),
                                 reinterpret_cast<const std::byte*>(stored.data()), sizeof(stored[0]), false});
      },
      table.storage.back());
}

Result<ScanPoints> points_from_table(const PointTable& table) {
  if (table.columns.size() > kMostColumns) {
    return fail(ErrorKind::kLimit, "has more than " + std::to_string(kMostColumns) + " values for each point");
  }
  NamedColumns named = name_columns(table);
  const auto xyz = take_triple(named, "x", "y", "z");
  if (!xyz) return fail(ErrorKind::kInvalidInput, "has no x, y and z for its points");
  if (table.rows == 0) return fail(ErrorKind::kInvalidInput, "has no points");
  ScanPoints points;
  points.positions = read_vectors<glm::dvec3>(*xyz, table.rows);
  if (const auto normal = take_triple(named, "nx", "ny", "nz")) {
    points.normals = read_vectors<glm::vec3>(*normal, table.rows);
  }
  if (const Column* radius = take(named, "radius")) {
    points.radii.resize(table.rows);
    for_each_value(*radius, table.rows, [&](size_t i, auto value) { points.radii[i] = static_cast<float>(value); });
  }
  take_colors(named, table.rows, points);
  take_scalars(named, table, points);
  return points;
}

}  // namespace surfcast
