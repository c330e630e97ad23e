#include "scan/ept_reader.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include <zstd.h>

#include "base/invalid_input.h"
#include "scan/json_access.h"
#include "scan/las_reader.h"
#include "scan/text_tokens.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

/// Depth and place of a node.
using Key = std::array<uint32_t, 4>;

constexpr uint32_t kDeepest = 31;

/// A dimension of the schema, as binary tiles store it.
struct Dimension {
  std::string name;
  ScalarType type = ScalarType::kInt32;
  double scale = 1;
  double offset = 0;

  [[nodiscard]] bool scaled() const { return scale != 1 || offset != 0; }
};

enum class TileCoding { kLaz, kBinary, kZstandard };

struct EptScan {
  fs::path folder;
  TileCoding coding = TileCoding::kLaz;
  geometry::Box cube;
  std::vector<Dimension> schema;
  std::string crs;
  std::map<Key, uint64_t> nodes;  ///< points of each

  [[nodiscard]] size_t record_bytes() const {
    size_t bytes = 0;
    for (const Dimension& dimension : schema) bytes += size_of(dimension.type);
    return bytes;
  }
};

std::string name_of(const Key& key) {
  return std::to_string(key[0]) + '-' + std::to_string(key[1]) + '-' + std::to_string(key[2]) + '-' +
         std::to_string(key[3]);
}

std::optional<Key> parse_key(std::string_view text) {
  Key key{};
  for (size_t i = 0; i < key.size(); ++i) {
    const size_t end = i + 1 < key.size() ? text.find('-') : text.size();
    if (end == std::string_view::npos) return std::nullopt;
    const auto number = parse_number<uint32_t>(text.substr(0, end));
    if (!number) return std::nullopt;
    key[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const bool inside = key[0] <= kDeepest && ((key[1] | key[2] | key[3]) >> key[0]) == 0;
  return inside ? std::optional(key) : std::nullopt;
}

std::optional<ScalarType> type_of_dimension(const std::string& kind, uint64_t size) {
  constexpr std::array kUnsigned = {ScalarType::kUint8, ScalarType::kUint16, ScalarType::kUint32, ScalarType::kUint64};
  constexpr std::array kSigned = {ScalarType::kInt8, ScalarType::kInt16, ScalarType::kInt32, ScalarType::kInt64};
  if (size != 1 && size != 2 && size != 4 && size != 8) return std::nullopt;
  const size_t power = size == 1 ? 0 : size == 2 ? 1 : size == 4 ? 2 : 3;
  if (kind == "unsigned") return kUnsigned.at(power);
  if (kind == "signed") return kSigned.at(power);
  if (kind == "float" && size == 4) return ScalarType::kFloat32;
  if (kind == "float" && size == 8) return ScalarType::kFloat64;
  return std::nullopt;
}

Status parse_schema(const Json& json, EptScan& scan) {
  for (const Json& entry : member(json, "schema")) {
    const std::string name = text_of(entry, "name");
    const auto type = type_of_dimension(text_of(entry, "type"), integer_of(entry, "size").value_or(0));
    if (!type) return invalid_input("the type of EPT dimension " + printable(name) + " is not supported");
    const double scale = number_of(entry, "scale", 1);
    const double offset = number_of(entry, "offset", 0);
    if (!std::isfinite(scale) || scale == 0 || !std::isfinite(offset)) {
      return invalid_input("EPT dimension " + printable(name) + " has an unusable scale");
    }
    scan.schema.push_back({name, *type, scale, offset});
  }
  return scan.schema.empty() ? Status(invalid_input("the EPT schema is missing")) : Status();
}

std::string crs_of(const Json& srs) {
  if (std::string wkt = text_of(srs, "wkt"); !wkt.empty()) return wkt;
  const std::string authority = text_of(srs, "authority");
  const std::string code = text_of(srs, "horizontal");
  return authority.empty() || code.empty() ? std::string() : authority + ':' + code;
}

Result<EptScan> parse_ept(const fs::path& folder, std::span<const std::byte> bytes) {
  const Json json = Json::parse(as_text(bytes), nullptr, false);
  if (!json.is_object()) return invalid_input("is no JSON object");
  EptScan scan;
  scan.folder = folder;
  const std::string coding = text_of(json, "dataType");
  if (coding != "laszip" && coding != "binary" && coding != "zstandard") {
    return fail(ErrorKind::kUnsupported, "EPT data of type " + printable(coding) + " is not supported");
  }
  scan.coding = coding == "laszip"   ? TileCoding::kLaz
                : coding == "binary" ? TileCoding::kBinary
                                     : TileCoding::kZstandard;
  const auto bounds = numbers_of(json, "bounds", 6);
  if (!bounds) return invalid_input("the EPT bounds are missing");
  scan.cube.min = {(*bounds)[0], (*bounds)[1], (*bounds)[2]};
  scan.cube.max = {(*bounds)[3], (*bounds)[4], (*bounds)[5]};
  if (Status status = parse_schema(json, scan); !status) return fail(status.error());
  scan.crs = crs_of(member(json, "srs"));
  return scan;
}

/// The cell of a node, a little larger: its points were placed before they were rounded.
geometry::Box cell_of(const geometry::Box& cube, const Key& key) {
  const glm::dvec3 step = cube.size() * std::ldexp(1, -static_cast<int>(key[0]));
  const glm::dvec3 place(key[1], key[2], key[3]);
  geometry::Box cell;
  cell.min = cube.min + step * (place - 0.01);
  cell.max = cube.min + step * (place + 1.01);
  return cell;
}

Status read_page(const Key& key, const Selection& selection, EptScan& scan, std::vector<Key>& pages) {
  const Result<TileFile> file = TileFile::open(scan.folder, "ept-hierarchy/" + name_of(key) + ".json");
  if (!file) return fail(file.error());
  const Json json = Json::parse(as_text(file->bytes()), nullptr, false);
  if (!json.is_object()) return file->error("is no JSON object");
  for (const auto& [name, count] : json.items()) {
    const std::optional<Key> node = parse_key(name);
    if (!node || !count.is_number_integer()) return file->error("has an entry that cannot be: " + printable(name));
    if (!geometry::may_meet(selection.zone, cell_of(scan.cube, *node))) continue;
    const auto points = count.get<int64_t>();
    if (points < -1) return file->error("has a node of fewer than no points");
    if (points == -1) pages.push_back(*node);
    if (points > 0) scan.nodes[*node] = static_cast<uint64_t>(points);
  }
  return {};
}

Status read_hierarchy(const Selection& selection, EptScan& scan) {
  std::vector<Key> pages{{0, 0, 0, 0}};
  std::set<Key> seen;
  while (!pages.empty()) {
    const Key key = pages.back();
    pages.pop_back();
    if (!seen.insert(key).second) return invalid_input("a page of the EPT hierarchy is within itself: " + name_of(key));
    if (Status status = read_page(key, selection, scan, pages); !status) return status;
  }
  return {};
}

std::vector<ColumnInfo> binary_columns(const EptScan& scan) {
  std::vector<ColumnInfo> columns;
  for (const Dimension& dimension : scan.schema) {
    columns.push_back({dimension.name, dimension.scaled() ? ScalarType::kFloat64 : dimension.type, true});
  }
  return columns;
}

/// Packed records of the schema. Scaled values become doubles.
PointTable binary_table(const EptScan& scan, std::vector<std::byte> records) {
  PointTable table;
  table.records = std::move(records);
  const size_t stride = scan.record_bytes();
  table.rows = table.records.size() / stride;
  const std::byte* first = table.records.data();
  for (const Dimension& dimension : scan.schema) {
    const Column stored{dimension.type, first, stride, false};
    first += size_of(dimension.type);
    if (!dimension.scaled()) {
      table.columns.push_back(stored);
      continue;
    }
    std::vector<double> values(table.rows);
    for_each_value(stored, table.rows, [&](size_t i, auto value) {
      values[i] = static_cast<double>(value) * dimension.scale + dimension.offset;
    });
    add_column(table, std::move(values));
  }
  return table;
}

/// More than Zstandard makes of a byte: blocks of 128 KiB that repeat one byte take four.
constexpr uint64_t kMostExpansion = 65536;

/// Frames do not state their size: they must give exactly that many bytes.
Result<std::vector<std::byte>> decompress(const TileFile& file, uint64_t bytes) {
  if (bytes / kMostExpansion > file.bytes().size()) return file.error("has not the points that the hierarchy states");
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
  std::vector<std::byte> records(bytes);
  ZSTD_inBuffer in{file.bytes().data(), file.bytes().size(), 0};
  ZSTD_outBuffer out{records.data(), records.size(), 0};
  size_t left = 1;
  while (left != 0 && (in.pos < in.size || out.pos < out.size)) {
    const size_t before = in.pos + out.pos;
    left = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(left) != 0) return file.error(std::string("is damaged: ") + ZSTD_getErrorName(left));
    if (in.pos + out.pos == before) break;
  }
  if (left != 0 || out.pos != out.size) return file.error("has not the points that the hierarchy states");
  return records;
}

Result<PointTable> read_tile(const EptScan& scan, const std::vector<ColumnInfo>& columns, const Key& key,
                             uint64_t count) {
  constexpr std::array kExtensions{".laz", ".bin", ".zst"};
  const std::string name = "ept-data/" + name_of(key) + kExtensions.at(static_cast<size_t>(scan.coding));
  const Result<TileFile> file = TileFile::open(scan.folder, name);
  if (!file) return fail(file.error());
  if (scan.coding == TileCoding::kLaz) {
    const auto rows = las_rows(file->bytes());
    if (!rows) return file->error(rows.error());
    if ((*rows)->columns() != columns) return file->error("has not the attributes of the other tiles");
    Result<PointTable> table = all_rows(**rows);
    return table ? std::move(table) : file->error(table.error());
  }
  const uint64_t bytes = count * scan.record_bytes();
  if (scan.coding == TileCoding::kBinary) {
    if (file->bytes().size() != bytes) return file->error("has not the points that the hierarchy states");
    return binary_table(scan, {file->bytes().begin(), file->bytes().end()});
  }
  Result<std::vector<std::byte>> records = decompress(*file, bytes);
  if (!records) return fail(std::move(records.error()));
  return binary_table(scan, std::move(*records));
}

/// The columns of LAZ tiles are those of the first one.
Result<std::vector<ColumnInfo>> columns_of(const EptScan& scan) {
  if (scan.coding != TileCoding::kLaz || scan.nodes.empty()) return binary_columns(scan);
  const Result<TileFile> file = TileFile::open(scan.folder, "ept-data/" + name_of(scan.nodes.begin()->first) + ".laz");
  if (!file) return fail(file.error());
  const auto rows = las_rows(file->bytes());
  if (!rows) return file->error(rows.error());
  return (*rows)->columns();
}

}  // namespace

Result<std::unique_ptr<RowSource>> ept_rows(const fs::path& path, const DecodingLimit& limit,
                                            const Selection& selection) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file.error());
  Result<EptScan> parsed = parse_ept(path.parent_path(), file->bytes());
  if (!parsed) return fail(std::move(parsed.error()));
  if (Status status = read_hierarchy(selection, *parsed); !status) return fail(status.error());
  const auto scan = std::make_shared<const EptScan>(std::move(*parsed));
  Result<std::vector<ColumnInfo>> columns = columns_of(*scan);
  if (!columns) return fail(std::move(columns.error()));
  TileSet tiles;
  tiles.traits.crs = scan->crs;
  tiles.columns = *columns;
  std::vector<Key> keys;
  for (const auto& [key, count] : scan->nodes) {
    keys.push_back(key);
    tiles.counts.push_back(count);
  }
  tiles.read = [scan, keys = std::move(keys), columns = std::move(*columns)](size_t tile) {
    return read_tile(*scan, columns, keys[tile], scan->nodes.at(keys[tile]));
  };
  return tile_rows(std::move(tiles), limit);
}

}  // namespace surfcast::scan
