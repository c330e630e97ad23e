#include "scan/potree_reader.h"

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <brotli/decode.h>

#include "base/contract.h"
#include "base/invalid_input.h"
#include "base/json_text.h"
#include "scan/column_names.h"
#include "scan/las_reader.h"
#include "scan/oct_normal.h"
#include "scan/potree_index.h"
#include "scan/text_tokens.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

enum class Meaning { kPosition, kColor, kOctNormal, kPlain, kSkipped };

/// A run of bytes of every point, and the columns it becomes.
struct PotreeAttribute {
  Meaning meaning = Meaning::kSkipped;
  size_t bytes = 0;
  std::vector<ColumnInfo> columns;
};

struct PotreeScan {
  fs::path folder;
  geometry::Box cube;
  glm::dvec3 scale{1};
  glm::dvec3 offset{0};  ///< version 2
  std::vector<PotreeAttribute> attributes;
  std::vector<PotreeNode> nodes;
  double spacing = 0;  ///< version 2: of the points of the root; 0: not stated
  // Version 1.
  std::string directory;
  uint64_t step = 0;      ///< digits of a folder's name; 0: all nodes in one folder
  std::string extension;  ///< .bin, .las or .laz
  // Version 2.
  bool brotli = false;
  std::shared_ptr<const TileFile> points;

  [[nodiscard]] size_t record_bytes() const {
    size_t bytes = 0;
    for (const PotreeAttribute& attribute : attributes) bytes += attribute.bytes;
    return bytes;
  }
  [[nodiscard]] std::vector<ColumnInfo> columns() const {
    std::vector<ColumnInfo> all;
    for (const PotreeAttribute& attribute : attributes) {
      all.insert(all.end(), attribute.columns.begin(), attribute.columns.end());
    }
    return all;
  }
};

Result<geometry::Box> cube_of(const Json& json, std::array<const char*, 6> names) {
  geometry::Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = number_of(json, names[static_cast<size_t>(axis)], NAN);
    box.max[axis] = number_of(json, names[static_cast<size_t>(axis) + 3], NAN);
  }
  if (box.empty() || !std::isfinite(box.diagonal())) return invalid_input("the Potree bounding box is missing");
  return box;
}

std::vector<ColumnInfo> doubles(std::initializer_list<const char*> names) {
  std::vector<ColumnInfo> columns;
  for (const char* name : names) columns.push_back({name, ScalarType::kFloat64, false});
  return columns;
}

std::vector<ColumnInfo> colors(ScalarType type) {
  return {{"red", type, false}, {"green", type, false}, {"blue", type, false}};
}

PotreeAttribute normal_attribute(Meaning meaning, size_t bytes) {
  constexpr auto kF32 = ScalarType::kFloat32;
  return {meaning, bytes, {{"nx", kF32, false}, {"ny", kF32, false}, {"nz", kF32, false}}};
}

// ---- version 1

/// An attribute of BIN nodes, by its name (PointAttribute.js of Potree 1).
std::optional<PotreeAttribute> bin_attribute(const std::string& name) {
  using Plain = std::pair<const char*, ColumnInfo>;
  static const std::array kPlain{Plain{"INTENSITY", {"intensity", ScalarType::kUint16, true}},
                                 Plain{"CLASSIFICATION", {"classification", ScalarType::kUint8, true}},
                                 Plain{"RETURN_NUMBER", {"return_number", ScalarType::kUint8, true}},
                                 Plain{"NUMBER_OF_RETURNS", {"number_of_returns", ScalarType::kUint8, true}},
                                 Plain{"SOURCE_ID", {"point_source_id", ScalarType::kUint16, true}},
                                 Plain{"GPS_TIME", {"gps_time", ScalarType::kFloat64, true}},
                                 Plain{"INDICES", {"indices", ScalarType::kUint32, true}},
                                 Plain{"SPACING", {"spacing", ScalarType::kFloat32, true}}};
  if (name == "POSITION_CARTESIAN") return PotreeAttribute{Meaning::kPosition, 12, doubles({"x", "y", "z"})};
  if (name == "COLOR_PACKED" || name == "RGBA") return PotreeAttribute{Meaning::kPlain, 4, colors(ScalarType::kUint8)};
  if (name == "RGB" || name == "RGB_PACKED") return PotreeAttribute{Meaning::kPlain, 3, colors(ScalarType::kUint8)};
  if (name == "NORMAL_OCT16") return normal_attribute(Meaning::kOctNormal, 2);
  if (name == "NORMAL_SPHEREMAPPED") return PotreeAttribute{Meaning::kSkipped, 2, {}};
  if (name == "NORMAL" || name == "NORMAL_FLOATS") return normal_attribute(Meaning::kPlain, 12);
  for (const auto& [known, column] : kPlain) {
    if (name == known) return PotreeAttribute{Meaning::kPlain, size_of(column.type), {column}};
  }
  return std::nullopt;
}

Status parse_bin_attributes(const Json& list, PotreeScan& scan) {
  if (list.empty()) return invalid_input("the Potree description names no attributes");
  for (const Json& entry : list) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : text_of(entry, "name");
    std::optional<PotreeAttribute> attribute = bin_attribute(name);
    if (!attribute) {
      return fail(ErrorKind::kUnsupported, "Potree attribute " + printable(name) + " is not supported");
    }
    scan.attributes.push_back(std::move(*attribute));
  }
  return {};
}

Status parse_coding(const Json& json, PotreeScan& scan) {
  const Json& attributes = member(json, "pointAttributes");
  if (attributes.is_array()) {
    scan.extension = ".bin";
    return parse_bin_attributes(attributes, scan);
  }
  const std::string coding = text_of(json, "pointAttributes");
  if (coding != "LAZ" && coding != "LAS") {
    return fail(ErrorKind::kUnsupported, "Potree nodes as " + printable(coding) + " are not supported");
  }
  scan.extension = coding == "LAZ" ? ".laz" : ".las";
  return {};
}

Result<PotreeScan> parse_cloud(const fs::path& path, const Selection& selection) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  const Json json = parse_json_text(as_text(file->bytes()));
  if (!json.is_object()) return invalid_input("is no JSON object");
  PotreeScan scan;
  scan.folder = path.parent_path();
  const auto cube = cube_of(member(json, "boundingBox"), {"lx", "ly", "lz", "ux", "uy", "uz"});
  if (!cube) return fail(cube);
  scan.cube = *cube;
  scan.scale = glm::dvec3(number_of(json, "scale", 0.01));
  scan.directory = text_of(json, "octreeDir");
  if (!member(json, "hierarchy").is_array()) scan.step = integer_of(json, "hierarchyStepSize").value_or(0);
  if (Status status = parse_coding(json, scan); !status) return fail(status);
  Result<std::vector<PotreeNode>> nodes = potree1_nodes(scan.folder, json, scan.cube, selection);
  if (!nodes) return fail(nodes);
  scan.nodes = std::move(*nodes);
  return scan;
}

Result<TileFile> open_node(const PotreeScan& scan, const PotreeNode& node) {
  const std::string name =
      scan.step == 0 ? node.name + scan.extension : potree1_file(node.name, scan.step, scan.extension.c_str());
  return TileFile::open(scan.folder, scan.directory + '/' + name);
}

Result<PointTable> read_las_node(const TileFile& file, const std::vector<ColumnInfo>& columns) {
  const auto rows = las_rows(file.bytes());
  if (!rows) return file.error(rows.error());
  if ((*rows)->columns() != columns) return file.error("has not the attributes of the other nodes");
  Result<PointTable> table = all_rows(**rows);
  return table ? std::move(table) : file.error(table.error());
}

// ---- both versions

void add_positions(const std::byte* first, size_t stride, const glm::dvec3& scale, const glm::dvec3& offset,
                   bool is_signed, PointTable& table) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(table.rows);
    const std::byte* at = first + 4 * axis;
    for (double& value : values) {
      const double number = is_signed ? double{static_cast<double>(load<int32_t>(at))} : load<uint32_t>(at);
      value = number * scale[axis] + offset[axis];
      at += stride;
    }
    add_column(table, std::move(values));
  }
}

void add_oct_normals(const std::byte* first, size_t stride, PointTable& table) {
  std::array<std::vector<float>, 3> values;
  for (std::vector<float>& axis : values) axis.resize(table.rows);
  for (size_t i = 0; i < table.rows; ++i) {
    const std::byte* at = first + i * stride;
    const glm::vec3 n = oct_normal(load<uint8_t>(at) / 127.5 - 1, load<uint8_t>(at + 1) / 127.5 - 1);
    for (int axis = 0; axis < 3; ++axis) values[static_cast<size_t>(axis)][i] = n[axis];
  }
  for (std::vector<float>& axis : values) add_column(table, std::move(axis));
}

/// Values of an attribute that stand next to each other.
void add_plain(const PotreeAttribute& attribute, const std::byte* first, size_t stride, PointTable& table) {
  for (const ColumnInfo& column : attribute.columns) {
    table.columns.push_back({column.type, first, stride, false});
    first += size_of(column.type);
  }
}

/// Packed records. `offset`: of their positions.
PointTable record_table(const PotreeScan& scan, std::vector<std::byte> records, const glm::dvec3& offset,
                        bool is_signed) {
  PointTable table;
  table.records = std::move(records);
  const size_t stride = scan.record_bytes();
  SURFCAST_EXPECTS(stride > 0);
  table.rows = table.records.size() / stride;
  const std::byte* first = table.records.data();
  for (const PotreeAttribute& attribute : scan.attributes) {
    if (attribute.meaning == Meaning::kPosition) {
      add_positions(first, stride, scan.scale, offset, is_signed, table);
    } else if (attribute.meaning == Meaning::kOctNormal) {
      add_oct_normals(first, stride, table);
    } else if (attribute.meaning != Meaning::kSkipped) {
      add_plain(attribute, first, stride, table);
    }
    first += attribute.bytes;
  }
  return table;
}

TileSet tiles_of(const PotreeScan& scan, std::vector<ColumnInfo> columns) {
  TileSet tiles;
  tiles.columns = std::move(columns);
  for (const PotreeNode& node : scan.nodes) tiles.counts.push_back(node.points);
  return tiles;
}

// ---- version 2

std::optional<ScalarType> type_named(const std::string& name) {
  using Named = std::pair<std::string_view, ScalarType>;
  constexpr std::array kTypes{Named{"uint8", ScalarType::kUint8},   Named{"int8", ScalarType::kInt8},
                              Named{"uint16", ScalarType::kUint16}, Named{"int16", ScalarType::kInt16},
                              Named{"uint32", ScalarType::kUint32}, Named{"int32", ScalarType::kInt32},
                              Named{"uint64", ScalarType::kUint64}, Named{"int64", ScalarType::kInt64},
                              Named{"float", ScalarType::kFloat32}, Named{"double", ScalarType::kFloat64}};
  for (const auto& [known, type] : kTypes) {
    if (name == known) return type;
  }
  return std::nullopt;
}

Result<PotreeAttribute> parse_attribute(const Json& json) {
  const std::string name = text_of(json, "name");
  const std::optional<ScalarType> type = type_named(text_of(json, "type"));
  const uint64_t elements = integer_of(json, "numElements").value_or(0);
  if (!type || elements == 0 || elements > 64 || integer_of(json, "size") != elements * size_of(*type)) {
    return invalid_input("Potree attribute " + printable(name) + " is damaged or not supported");
  }
  const size_t bytes = elements * size_of(*type);
  if (name == "position") {
    if (elements != 3 || *type != ScalarType::kInt32) return invalid_input("Potree positions are not 32 bit integers");
    return PotreeAttribute{Meaning::kPosition, bytes, doubles({"x", "y", "z"})};
  }
  if ((name == "rgb" || name == "rgba") && elements >= 3) {
    const bool wide = *type == ScalarType::kUint16 && elements == 3;
    return PotreeAttribute{wide ? Meaning::kColor : Meaning::kPlain, bytes, colors(*type)};
  }
  PotreeAttribute attribute{Meaning::kPlain, bytes, {}};
  for (uint64_t i = 0; i < elements; ++i) {
    const std::string canonical = canonical_attribute_name(name);
    attribute.columns.push_back({elements == 1 ? canonical : canonical + '_' + std::to_string(i), *type, true});
  }
  return attribute;
}

Result<PotreeScan> parse_metadata(const fs::path& path, const Selection& selection) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  const Json json = parse_json_text(as_text(file->bytes()));
  PotreeScan scan;
  scan.folder = path.parent_path();
  const auto scale = numbers_of(json, "scale", 3);
  const auto offset = numbers_of(json, "offset", 3);
  const auto low = numbers_of(member(json, "boundingBox"), "min", 3);
  const auto high = numbers_of(member(json, "boundingBox"), "max", 3);
  if (!scale || !offset || !low || !high)
    return invalid_input("the Potree metadata have no scale, offset or bounding box");
  scan.scale = {(*scale)[0], (*scale)[1], (*scale)[2]};
  scan.offset = {(*offset)[0], (*offset)[1], (*offset)[2]};
  scan.cube.min = {(*low)[0], (*low)[1], (*low)[2]};
  scan.cube.max = {(*high)[0], (*high)[1], (*high)[2]};
  const std::string encoding = text_of(json, "encoding");
  if (encoding != "DEFAULT" && encoding != "UNCOMPRESSED" && encoding != "BROTLI") {
    return fail(ErrorKind::kUnsupported, "Potree encoding " + printable(encoding) + " is not supported");
  }
  scan.brotli = encoding == "BROTLI";
  scan.spacing = number_of(json, "spacing", 0);
  for (const Json& entry : member(json, "attributes")) {
    Result<PotreeAttribute> attribute = parse_attribute(entry);
    if (!attribute) return fail(attribute);
    scan.attributes.push_back(std::move(*attribute));
  }
  if (scan.attributes.empty()) return invalid_input("the Potree metadata name no attributes");
  Result<std::vector<PotreeNode>> nodes = potree2_nodes(scan.folder, json, scan.cube, selection);
  if (!nodes) return fail(nodes);
  scan.nodes = std::move(*nodes);
  Result<TileFile> points = TileFile::open(scan.folder, "octree.bin");
  if (!points) return fail(points);
  scan.points = std::make_shared<const TileFile>(std::move(*points));
  return scan;
}

/// Bytes of a point in a column of BROTLI nodes: positions as two Morton words of 64 bits, colours as one.
size_t brotli_bytes(const PotreeAttribute& attribute) {
  return attribute.meaning == Meaning::kPosition ? 16 : attribute.meaning == Meaning::kColor ? 8 : attribute.bytes;
}

/// 16 bits of one of three axes out of a Morton word.
uint32_t unmix(uint64_t word, int axis) {
  uint32_t bits = 0;
  for (int bit = 0; bit < 16; ++bit) bits |= static_cast<uint32_t>(word >> (3 * bit + axis) & 1) << bit;
  return bits;
}

/// Turns the columns of a BROTLI node into the records of a DEFAULT one.
std::vector<std::byte> records_of_columns(const PotreeScan& scan, const std::vector<std::byte>& columns, size_t rows) {
  const size_t stride = scan.record_bytes();
  std::vector<std::byte> records(rows * stride);
  const std::byte* from = columns.data();
  std::byte* first = records.data();
  for (const PotreeAttribute& attribute : scan.attributes) {
    for (size_t i = 0; i < rows; ++i, from += brotli_bytes(attribute)) {
      std::byte* to = first + i * stride;
      for (int axis = 0; axis < 3 && attribute.meaning == Meaning::kPosition; ++axis) {
        const uint32_t value = unmix(load<uint64_t>(from), axis) << 16 | unmix(load<uint64_t>(from + 8), axis);
        std::memcpy(to + 4 * axis, &value, sizeof(value));
      }
      for (int axis = 0; axis < 3 && attribute.meaning == Meaning::kColor; ++axis) {
        const auto value = static_cast<uint16_t>(unmix(load<uint64_t>(from), axis));
        std::memcpy(to + 2 * axis, &value, sizeof(value));
      }
      if (brotli_bytes(attribute) == attribute.bytes) std::memcpy(to, from, attribute.bytes);
    }
    first += attribute.bytes;
  }
  return records;
}

/// `bytes`: of the node.
Result<PointTable> points_of_node2(const PotreeScan& scan, const PotreeNode& node, std::span<const std::byte> bytes) {
  if (!scan.brotli) {
    if (node.bytes != node.points * scan.record_bytes()) return scan.points->error("node " + node.name + " is damaged");
    return record_table(scan, {bytes.begin(), bytes.end()}, scan.offset, true);
  }
  size_t size = 0;
  for (const PotreeAttribute& attribute : scan.attributes) size += brotli_bytes(attribute) * node.points;
  std::vector<std::byte> columns(size);
  const auto outcome = BrotliDecoderDecompress(bytes.size(), reinterpret_cast<const uint8_t*>(bytes.data()), &size,
                                               reinterpret_cast<uint8_t*>(columns.data()));
  if (outcome != BROTLI_DECODER_RESULT_SUCCESS || size != columns.size()) {
    return scan.points->error("node " + node.name + " is damaged");
  }
  return record_table(scan, records_of_columns(scan, columns, node.points), scan.offset, true);
}

Result<PointTable> read_node2(const PotreeScan& scan, const PotreeNode& node) {
  const std::span<const std::byte> all = scan.points->bytes();
  if (node.offset > all.size() || node.bytes > all.size() - node.offset) {
    return scan.points->error("truncated: node " + node.name + " lies beyond the end of the file");
  }
  return points_of_node2(scan, node, all.subspan(node.offset, node.bytes));
}

}  // namespace

Result<std::unique_ptr<RowSource>> potree1_rows(const fs::path& cloud, const DecodingLimit& limit,
                                                const Selection& selection) {
  Result<PotreeScan> parsed = parse_cloud(cloud, selection);
  if (!parsed) return fail(parsed);
  const auto scan = std::make_shared<const PotreeScan>(std::move(*parsed));
  if (scan->nodes.empty())
    return invalid_input(selection.zone.everywhere() ? "has no points" : "has no points in the selection");
  std::vector<ColumnInfo> columns = scan->columns();
  if (scan->extension != ".bin") {
    const Result<TileFile> file = open_node(*scan, scan->nodes.front());
    if (!file) return fail(file);
    const auto rows = las_rows(file->bytes());
    if (!rows) return file->error(rows.error());
    columns = (*rows)->columns();
  }
  TileSet tiles = tiles_of(*scan, columns);
  tiles.read = [scan, columns = std::move(columns)](size_t tile) -> Result<PointTable> {
    const PotreeNode& node = scan->nodes[tile];
    const Result<TileFile> file = open_node(*scan, node);
    if (!file) return fail(file);
    if (scan->extension != ".bin") return read_las_node(*file, columns);
    if (file->bytes().size() != node.points * scan->record_bytes()) {
      return file->error("has not the points that the hierarchy states");
    }
    return record_table(*scan, {file->bytes().begin(), file->bytes().end()}, potree_cube(scan->cube, node.name).min,
                        false);
  };
  return tile_rows(std::move(tiles), limit);
}

Result<std::unique_ptr<RowSource>> potree2_rows(const fs::path& metadata, const DecodingLimit& limit,
                                                const Selection& selection) {
  Result<PotreeScan> parsed = parse_metadata(metadata, selection);
  if (!parsed) return fail(parsed);
  const auto scan = std::make_shared<const PotreeScan>(std::move(*parsed));
  TileSet tiles = tiles_of(*scan, scan->columns());
  tiles.read = [scan](size_t tile) { return read_node2(*scan, scan->nodes[tile]); };
  return tile_rows(std::move(tiles), limit);
}

Result<Potree2Folder> open_potree2(const fs::path& metadata) {
  Result<PotreeScan> parsed = parse_metadata(metadata, {});
  if (!parsed) return fail(parsed);
  const auto scan = std::make_shared<const PotreeScan>(std::move(*parsed));
  return Potree2Folder{
      scan->cube,
      scan->spacing,
      {scan->scale, scan->offset},
      scan->nodes,
      scan->columns(),
      [scan](const PotreeNode& node, std::span<const std::byte> bytes) { return points_of_node2(*scan, node, bytes); }};
}

}  // namespace surfcast::scan
