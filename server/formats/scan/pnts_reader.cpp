#include "scan/pnts_reader.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "scan/move_points.h"
#include "scan/oct_normal.h"
#include "scan/readers.h"
#include "scan/sliced_rows.h"
#include "scan/text_tokens.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

using Bytes = std::span<const std::byte>;

constexpr size_t kPntsHeaderBytes = 28;

Result<Json> parse_table(Bytes text) {
  if (text.empty()) return Json::object();
  Json json = parse_json_text(as_text(text));
  if (!json.is_object()) return invalid_input("a table of the tile is no JSON object");
  return json;
}

// ---- Draco's part of a tile

const Json& draco_extension(const Json& table) {
  return member(member(table, "extensions"), "3DTILES_draco_point_compression");
}

/// The number of a property of a table within the Draco data; nothing if it is in the table itself.
std::optional<uint64_t> draco_number(const Json& table, const std::string& name) {
  return integer_of(member(draco_extension(table), "properties"), name.c_str());
}

bool is_draco(const PntsTile& tile) {
  return draco_extension(tile.features).is_object();
}

// ---- columns of values in the feature table and the batch table

std::optional<ScalarType> component_type(const std::string& name) {
  using Named = std::pair<std::string_view, ScalarType>;
  constexpr std::array kTypes{Named{"BYTE", ScalarType::kInt8},     Named{"UNSIGNED_BYTE", ScalarType::kUint8},
                              Named{"SHORT", ScalarType::kInt16},   Named{"UNSIGNED_SHORT", ScalarType::kUint16},
                              Named{"INT", ScalarType::kInt32},     Named{"UNSIGNED_INT", ScalarType::kUint32},
                              Named{"FLOAT", ScalarType::kFloat32}, Named{"DOUBLE", ScalarType::kFloat64}};
  for (const auto& [known, type] : kTypes) {
    if (name == known) return type;
  }
  return std::nullopt;
}

/// `count` values of so many bytes that a property refers to.
Result<Bytes> values_of(const Json& property, Bytes binary, uint64_t count, uint64_t bytes) {
  const uint64_t offset = integer_of(property, "byteOffset").value_or(0);
  if (offset > binary.size() || count > (binary.size() - offset) / bytes) {
    return invalid_input("truncated: the values of a pnts property lie beyond their table");
  }
  return binary.subspan(offset, count * bytes);
}

/// A property of batches or of points with one number each.
struct BatchProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat64;
};

/// Values per batch if points name their batch; per point otherwise.
std::vector<BatchProperty> batch_properties(const PntsTile& tile) {
  std::vector<BatchProperty> properties;
  for (const auto& [name, value] : tile.batches.items()) {
    const auto type = component_type(text_of(value, "componentType"));
    if (draco_number(tile.batches, name)) continue;
    if (type && text_of(value, "type") == "SCALAR") properties.push_back({printable(name), *type});
  }
  return properties;
}

/// The column of BATCH_ID in the feature table; nothing if points have none.
Result<std::optional<Column>> batch_id_column(const PntsTile& tile) {
  const Json& property = member(tile.features, "BATCH_ID");
  if (!property.is_object()) return std::nullopt;
  const std::string stated = text_of(property, "componentType");
  const auto type = component_type(stated.empty() ? "UNSIGNED_SHORT" : stated);
  if (!type || is_floating(*type)) return invalid_input("the type of BATCH_ID is not supported");
  const auto bytes = values_of(property, tile.feature_bytes, tile.points, size_of(*type));
  if (!bytes) return fail(bytes);
  return Column{*type, bytes->data(), size_of(*type), false};
}

/// The batch of every point.
Result<std::vector<uint32_t>> batch_ids(const PntsTile& tile, const Column& column) {
  const uint64_t batches = integer_of(tile.features, "BATCH_LENGTH").value_or(0);
  std::vector<uint32_t> ids(tile.points);
  bool inside = true;
  for_each_value(column, tile.points, [&](size_t i, auto value) {
    const auto id = static_cast<double>(value);  // exact: integers of at most 32 bits
    inside = inside && id >= 0.0 && id < static_cast<double>(batches);
    if (inside) ids[i] = static_cast<uint32_t>(id);
  });
  if (!inside) return invalid_input("a point names a batch that is not there");
  return ids;
}

Status add_batch_property(const PntsTile& tile, const BatchProperty& property, const std::vector<uint32_t>& ids,
                          PointTable& table) {
  const uint64_t rows = ids.empty() ? tile.points : integer_of(tile.features, "BATCH_LENGTH").value_or(0);
  const Json& json = member(tile.batches, property.name.c_str());
  const auto bytes = values_of(json, tile.batch_bytes, rows, size_of(property.type));
  if (!bytes) return fail(bytes);
  with_type(property.type, [&](auto zero) {
    using T = decltype(zero);
    std::vector<T> values(tile.points);
    for (size_t i = 0; i < values.size(); ++i) {
      values[i] = load<T>(bytes->data() + (ids.empty() ? i : ids[i]) * sizeof(T));
    }
    add_column(table, std::move(values));
  });
  return {};
}

// ---- positions, colours, normals

using Triples = std::vector<glm::dvec3>;

glm::dvec3 vector_of(const Json& json, const char* name, const glm::dvec3& otherwise) {
  const auto numbers = numbers_of(json, name, 3);
  return numbers ? glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2]) : otherwise;
}

/// Relative to RTC_CENTER.
Result<Triples> positions_of(const PntsTile& tile) {
  const bool quantised = !member(tile.features, "POSITION").is_object();
  const Json& property = member(tile.features, quantised ? "POSITION_QUANTIZED" : "POSITION");
  if (!property.is_object()) return invalid_input("the pnts tile has no positions");
  const size_t width = quantised ? sizeof(uint16_t) : sizeof(float);
  const auto bytes = values_of(property, tile.feature_bytes, tile.points, 3 * width);
  if (!bytes) return fail(bytes);
  const glm::dvec3 scale = vector_of(tile.features, "QUANTIZED_VOLUME_SCALE", glm::dvec3(1));
  const glm::dvec3 offset = vector_of(tile.features, "QUANTIZED_VOLUME_OFFSET", glm::dvec3(0));
  Triples positions(tile.points);
  const std::byte* at = bytes->data();
  for (glm::dvec3& position : positions) {
    for (int axis = 0; axis < 3; ++axis, at += width) {
      position[axis] = quantised ? load<uint16_t>(at) * scale[axis] / 65535.0 + offset[axis] : double{load<float>(at)};
    }
  }
  return positions;
}

using Color = std::array<uint8_t, 3>;

/// In the tables of the tile, not in its Draco data.
bool has_color(const PntsTile& tile) {
  if (draco_number(tile.features, "RGB") || draco_number(tile.features, "RGBA")) return false;
  for (const char* name : {"RGBA", "RGB", "RGB565", "CONSTANT_RGBA"}) {
    if (!member(tile.features, name).is_null()) return true;
  }
  return false;
}

Color unpack565(uint16_t packed) {
  const auto widen = [packed](int shift, int bits) {
    const int top = (1 << bits) - 1;
    return static_cast<uint8_t>(((packed >> shift & top) * 255 + top / 2) / top);
  };
  return {widen(11, 5), widen(5, 6), widen(0, 5)};
}

/// In the order of precedence that the specification gives them.
Result<std::vector<Color>> colors_of(const PntsTile& tile) {
  std::vector<Color> colors(tile.points);
  for (const auto& [name, width] : {std::pair{"RGBA", size_t{4}}, {"RGB", size_t{3}}, {"RGB565", size_t{2}}}) {
    const Json& property = member(tile.features, name);
    if (!property.is_object()) continue;
    const auto bytes = values_of(property, tile.feature_bytes, tile.points, width);
    if (!bytes) return fail(bytes);
    const std::byte* at = bytes->data();
    for (Color& color : colors) {
      color = width == 2 ? unpack565(load<uint16_t>(at))
                         : Color{load<uint8_t>(at), load<uint8_t>(at + 1), load<uint8_t>(at + 2)};
      at += width;
    }
    return colors;
  }
  const auto constant = numbers_of(tile.features, "CONSTANT_RGBA", 4);
  if (!constant) return invalid_input("the colour of the pnts tile is damaged");
  Color color{};
  for (size_t i = 0; i < 3; ++i) color[i] = static_cast<uint8_t>(std::fmin(std::fmax((*constant)[i], 0), 255));
  colors.assign(tile.points, color);
  return colors;
}

/// In the tables of the tile, not in its Draco data.
bool has_normal(const PntsTile& tile) {
  if (draco_number(tile.features, "NORMAL")) return false;
  return member(tile.features, "NORMAL").is_object() || member(tile.features, "NORMAL_OCT16P").is_object();
}

Result<Triples> normals_of(const PntsTile& tile) {
  const bool packed = !member(tile.features, "NORMAL").is_object();
  const auto bytes = values_of(member(tile.features, packed ? "NORMAL_OCT16P" : "NORMAL"), tile.feature_bytes,
                               tile.points, packed ? 2 : 12);
  if (!bytes) return fail(bytes);
  Triples normals(tile.points);
  const std::byte* at = bytes->data();
  for (glm::dvec3& normal : normals) {
    if (packed) {
      normal = oct_normal(load<uint8_t>(at) / 127.5 - 1, load<uint8_t>(at + 1) / 127.5 - 1);
    } else {
      normal = {load<float>(at), load<float>(at + 4), load<float>(at + 8)};
    }
    at += packed ? 2 : 12;
  }
  return normals;
}

// ---- tables

template <typename T>
void add_triples(const Triples& triples, PointTable& table) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<T> values(triples.size());
    for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<T>(triples[i][axis]);
    add_column(table, std::move(values));
  }
}

void place(const PntsTile& tile, const glm::dmat4& transform, Triples& positions) {
  const glm::dvec3 centre = centre_of(tile);
  for (glm::dvec3& position : positions) position += centre;
  move_points(transform, positions);
}

/// Beside positions, the columns that are in the tables of the tile.
std::vector<ColumnInfo> columns_of_tables(const PntsTile& tile) {
  std::vector<ColumnInfo> columns;
  for (const char* channel : {"red", "green", "blue"}) {
    if (has_color(tile)) columns.push_back({channel, ScalarType::kUint8, false});
  }
  for (const char* axis : {"nx", "ny", "nz"}) {
    if (has_normal(tile)) columns.push_back({axis, ScalarType::kFloat32, false});
  }
  for (const BatchProperty& property : batch_properties(tile)) columns.push_back({property.name, property.type, false});
  return columns;
}

Status add_colors(const PntsTile& tile, PointTable& table) {
  const Result<std::vector<Color>> colors = colors_of(tile);
  if (!colors) return fail(colors);
  for (size_t channel = 0; channel < 3; ++channel) {
    std::vector<uint8_t> values(colors->size());
    for (size_t i = 0; i < values.size(); ++i) values[i] = (*colors)[i][channel];
    add_column(table, std::move(values));
  }
  return {};
}

Status add_normals(const PntsTile& tile, const glm::dmat4& transform, PointTable& table) {
  Result<Triples> normals = normals_of(tile);
  if (!normals) return fail(normals);
  turn_normals(transform, *normals);
  add_triples<float>(*normals, table);
  return {};
}

/// `batch`: the batch of every point; nothing if values are stated for points.
Status add_batch_properties(const PntsTile& tile, const std::optional<Column>& batch, PointTable& table) {
  std::vector<uint32_t> ids;
  if (batch) {
    Result<std::vector<uint32_t>> read = batch_ids(tile, *batch);
    if (!read) return fail(read);
    ids = std::move(*read);
  }
  for (const BatchProperty& property : batch_properties(tile)) {
    if (Status status = add_batch_property(tile, property, ids, table); !status) return status;
  }
  return {};
}

/// The columns of columns_of_tables, in that order.
Status add_tables(const PntsTile& tile, const glm::dmat4& transform, const std::optional<Column>& batch,
                  PointTable& table) {
  if (has_color(tile)) {
    if (Status status = add_colors(tile, table); !status) return status;
  }
  if (has_normal(tile)) {
    if (Status status = add_normals(tile, transform, table); !status) return status;
  }
  return add_batch_properties(tile, batch, table);
}

std::vector<ColumnInfo> own_columns(const PntsTile& tile) {
  std::vector<ColumnInfo> columns;
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, ScalarType::kFloat64, false});
  for (ColumnInfo& column : columns_of_tables(tile)) columns.push_back(std::move(column));
  return columns;
}

Result<PointTable> own_table(const PntsTile& tile, const glm::dmat4& transform) {
  PointTable table;
  table.rows = tile.points;
  Result<Triples> positions = positions_of(tile);
  if (!positions) return fail(positions);
  place(tile, transform, *positions);
  add_triples<double>(*positions, table);
  const Result<std::optional<Column>> batch = batch_id_column(tile);
  if (!batch) return fail(batch);
  if (Status status = add_tables(tile, transform, *batch, table); !status) return fail(status);
  return table;
}

// ---- points of Draco data

/// The names that the batch table gives to attributes.
std::string draco_name(const PntsTile& tile, const std::string& name) {
  constexpr std::string_view kUnnamed = "attribute_";
  if (!name.starts_with(kUnnamed)) return name;
  for (const auto& [property, id] : member(draco_extension(tile.batches), "properties").items()) {
    const auto number = integer_of(id);
    if (!number) continue;
    const std::string numbered = std::string(kUnnamed) + std::to_string(*number);
    if (name.starts_with(numbered) && (name.size() == numbered.size() || name[numbered.size()] == '_')) {
      return printable(property) + name.substr(numbered.size());
    }
  }
  return name;
}

Result<std::unique_ptr<RowSource>> draco_of(const PntsTile& tile, const DecodingLimit& limit) {
  const Json& extension = draco_extension(tile.features);
  const uint64_t length = integer_of(extension, "byteLength").value_or(0);
  const auto bytes = values_of(extension, tile.feature_bytes, length, 1);
  if (!bytes) return fail(bytes);
  return draco_rows(*bytes, limit);
}

/// Columns of positions become doubles. Those behind them are in the tables of the tile.
std::vector<ColumnInfo> draco_columns(const PntsTile& tile, const RowSource& rows) {
  std::vector<ColumnInfo> columns = rows.columns();
  for (ColumnInfo& column : columns) {
    if (column.name == "x" || column.name == "y" || column.name == "z") column.type = ScalarType::kFloat64;
    column.name = draco_name(tile, column.name);
  }
  for (ColumnInfo& column : columns_of_tables(tile)) columns.push_back(std::move(column));
  return columns;
}

size_t index_of(const std::vector<ColumnInfo>& columns, std::string_view name) {
  size_t i = 0;
  while (i < columns.size() && columns[i].name != name) ++i;
  return i;
}

/// Three columns out of a table; empty if one is missing.
Triples triples_of(const std::vector<ColumnInfo>& columns, const PointTable& table,
                   const std::array<const char*, 3>& names) {
  Triples triples(table.rows);
  for (int axis = 0; axis < 3; ++axis) {
    const size_t column = index_of(columns, names[static_cast<size_t>(axis)]);
    if (column == columns.size()) return {};
    for_each_value(table.columns[column], table.rows,
                   [&](size_t i, auto value) { triples[i][axis] = static_cast<double>(value); });
  }
  return triples;
}

template <typename T>
void replace(const std::vector<ColumnInfo>& columns, const std::array<const char*, 3>& names, const Triples& triples,
             PointTable& table) {
  PointTable made;
  add_triples<T>(triples, made);
  for (size_t axis = 0; axis < 3; ++axis) {
    table.columns[index_of(columns, names[axis])] = made.columns[axis];
    table.storage.push_back(std::move(made.storage[axis]));
  }
}

/// The batch of every point, in the Draco data or in the feature table.
Result<std::optional<Column>> draco_batch_column(const PntsTile& tile, const std::vector<ColumnInfo>& columns,
                                                 const PointTable& table) {
  if (batch_properties(tile).empty()) return std::nullopt;
  const auto number = draco_number(tile.features, "BATCH_ID");
  if (!number) return batch_id_column(tile);
  const size_t column = index_of(columns, "attribute_" + std::to_string(*number));
  if (column == columns.size() || is_floating(columns[column].type)) {
    return invalid_input("the Draco data have no BATCH_ID");
  }
  return table.columns[column];
}

/// In the order of the decoder, which is that of the tables: encoders keep the order of points where a tile has both.
Result<PointTable> draco_table(const PntsTile& tile, const glm::dmat4& transform, const DecodingLimit& limit) {
  constexpr std::array<const char*, 3> kPosition{"x", "y", "z"};
  constexpr std::array<const char*, 3> kNormal{"nx", "ny", "nz"};
  const auto rows = draco_of(tile, limit);
  if (!rows) return fail(rows);
  Result<PointTable> table = all_rows(**rows);
  if (!table) return table;
  if (table->rows != tile.points) return invalid_input("the Draco data have not the points that the pnts tile states");
  const std::vector<ColumnInfo>& columns = (*rows)->columns();
  Triples positions = triples_of(columns, *table, kPosition);
  if (positions.empty()) return invalid_input("the pnts tile has no positions");
  place(tile, transform, positions);
  replace<double>(columns, kPosition, positions, *table);
  if (Triples normals = triples_of(columns, *table, kNormal); !normals.empty()) {
    turn_normals(transform, normals);
    replace<float>(columns, kNormal, normals, *table);
  }
  const Result<std::optional<Column>> batch = draco_batch_column(tile, columns, *table);
  if (!batch) return fail(batch);
  if (Status status = add_tables(tile, transform, *batch, *table); !status) return fail(status);
  return table;
}

}  // namespace

Result<TileTables> split_tile(Bytes bytes) {
  if (bytes.size() < kPntsHeaderBytes) return invalid_input("truncated: the file ends within its header");
  const auto version = load<uint32_t>(&bytes[4]);
  if (version != 1) {
    const std::string kind = printable(as_text(bytes).substr(0, 4));
    return fail(ErrorKind::kUnsupported, kind + " version " + std::to_string(version) + " is not supported");
  }
  std::array<Bytes, 4> parts;
  size_t at = kPntsHeaderBytes;
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto size = load<uint32_t>(&bytes[12 + 4 * i]);
    if (size > bytes.size() - at) return invalid_input("truncated: the tables of the tile run beyond the file");
    parts[i] = bytes.subspan(at, size);
    at += size;
  }
  Result<Json> features = parse_table(parts[0]);
  Result<Json> batches = parse_table(parts[2]);
  if (!features) return fail(features);
  if (!batches) return fail(batches);
  return TileTables{std::move(*features), parts[1], std::move(*batches), parts[3], bytes.subspan(at)};
}

glm::dvec3 centre_of(const TileTables& tables) {
  return vector_of(tables.features, "RTC_CENTER", glm::dvec3(0));
}

Result<PntsTile> parse_pnts(Bytes bytes) {
  Result<TileTables> tables = split_tile(bytes);
  if (!tables) return fail(tables);
  PntsTile tile{std::move(*tables), 0};
  tile.points = integer_of(tile.features, "POINTS_LENGTH").value_or(0);
  if (tile.points > tile.feature_bytes.size() * uint64_t{1024})
    return invalid_input("the pnts tile states more points than it can hold");
  return tile;
}

Result<std::vector<ColumnInfo>> pnts_columns(const PntsTile& tile, const DecodingLimit& limit) {
  if (!is_draco(tile)) return own_columns(tile);
  const auto rows = draco_of(tile, limit);
  if (!rows) return fail(rows);
  return draco_columns(tile, **rows);
}

Result<PointTable> pnts_table(const PntsTile& tile, const glm::dmat4& transform, const DecodingLimit& limit) {
  return is_draco(tile) ? draco_table(tile, transform, limit) : own_table(tile, transform);
}

Result<std::unique_ptr<RowSource>> pnts_rows(Bytes bytes, const DecodingLimit& limit) {
  const Result<PntsTile> tile = parse_pnts(bytes);
  if (!tile) return fail(tile);
  Result<std::vector<ColumnInfo>> columns = pnts_columns(*tile, limit);
  if (!columns) return fail(columns);
  Result<PointTable> table = pnts_table(*tile, glm::dmat4(1), limit);
  if (!table) return fail(table);
  return std::make_unique<SlicedRows>(RowTraits(), std::move(*columns), std::move(*table));
}

}  // namespace surfcast::scan
