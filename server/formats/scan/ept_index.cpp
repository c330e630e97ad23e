#include "scan/ept_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <zstd.h>

#include "base/contract.h"
#include "base/invalid_input.h"
#include "base/json_text.h"
#include "scan/json_access.h"
#include "scan/las_reader.h"
#include "scan/text_tokens.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

constexpr uint32_t kDeepestEpt = 31;

std::optional<EptKey> parse_key(std::string_view text) {
  EptKey key{};
  for (size_t i = 0; i < key.size(); ++i) {
    const size_t end = i + 1 < key.size() ? text.find('-') : text.size();
    if (end == std::string_view::npos) return std::nullopt;
    const auto number = parse_number<uint32_t>(text.substr(0, end));
    if (!number) return std::nullopt;
    key[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const bool inside = key[0] <= kDeepestEpt && ((key[1] | key[2] | key[3]) >> key[0]) == 0;
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

Status parse_schema(const Json& json, EptDescription& ept) {
  for (const Json& entry : member(json, "schema")) {
    const std::string name = text_of(entry, "name");
    const auto type = type_of_dimension(text_of(entry, "type"), integer_of(entry, "size").value_or(0));
    if (!type) return invalid_input("the type of EPT dimension " + printable(name) + " is not supported");
    const double scale = number_of(entry, "scale", 1);
    const double offset = number_of(entry, "offset", 0);
    if (!std::isfinite(scale) || scale == 0 || !std::isfinite(offset)) {
      return invalid_input("EPT dimension " + printable(name) + " has an unusable scale");
    }
    ept.schema.push_back({name, *type, scale, offset});
  }
  return ept.schema.empty() ? Status(invalid_input("the EPT schema is missing")) : Status();
}

std::string crs_of(const Json& srs) {
  if (std::string wkt = text_of(srs, "wkt"); !wkt.empty()) return wkt;
  const std::string authority = text_of(srs, "authority");
  const std::string code = text_of(srs, "horizontal");
  return authority.empty() || code.empty() ? std::string() : authority + ':' + code;
}

/// The cell of a node, a little larger: its points were placed before they were rounded.
geometry::Box ept_cell(const geometry::Box& cube, const EptKey& key) {
  const glm::dvec3 step = cube.size() * std::ldexp(1, -static_cast<int>(key[0]));
  const glm::dvec3 place(key[1], key[2], key[3]);
  geometry::Box cell;
  cell.min = cube.min + step * (place - 0.01);
  cell.max = cube.min + step * (place + 1.01);
  return cell;
}

std::string page_name(const EptKey& key) {
  return "ept-hierarchy/" + ept_name(key) + ".json";
}

/// Takes the nodes of a page, and the keys of pages below it.
Status take_page(const EptDescription& ept, std::span<const std::byte> bytes, const geometry::Zone& zone,
                 EptNodes& nodes, std::vector<EptKey>& pages) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object()) return invalid_input("is no JSON object");
  for (const auto& [name, count] : json.items()) {
    const std::optional<EptKey> node = parse_key(name);
    if (!node || !count.is_number_integer()) return invalid_input("has an entry that cannot be: " + printable(name));
    if (!geometry::may_meet(zone, ept_cell(ept.cube, *node))) continue;
    const auto points = count.get<int64_t>();
    if (points < -1) return invalid_input("has a node of fewer than no points");
    if (points == -1) pages.push_back(*node);
    if (points >= 0) nodes[*node] = static_cast<uint64_t>(points);
  }
  return {};
}

std::vector<ColumnInfo> binary_columns(const EptDescription& ept) {
  std::vector<ColumnInfo> columns;
  for (const EptDimension& dimension : ept.schema) {
    columns.push_back({dimension.name, dimension.scaled() ? ScalarType::kFloat64 : dimension.type, true});
  }
  return columns;
}

/// The lattice of binary tiles: the scale and offset of X, Y and Z.
std::optional<surfel::Grid> binary_grid(const EptDescription& ept) {
  surfel::Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, static_cast<char>('X' + axis));
    const auto found = std::ranges::find(ept.schema, name, &EptDimension::name);
    if (found == ept.schema.end() || is_floating(found->type) || !found->scaled()) return std::nullopt;
    grid.scale[axis] = found->scale;
    grid.offset[axis] = found->offset;
  }
  return grid;
}

/// Packed records of the schema. Scaled values become doubles.
PointTable binary_table(const EptDescription& ept, std::vector<std::byte> records) {
  PointTable table;
  table.records = std::move(records);
  const size_t stride = ept.record_bytes();
  SURFCAST_EXPECTS(stride > 0);
  table.rows = table.records.size() / stride;
  const std::byte* first = table.records.data();
  for (const EptDimension& dimension : ept.schema) {
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
constexpr uint64_t kMaxTileExpansion = 65536;

/// Frames do not state their size: they must give exactly that many bytes.
Result<std::vector<std::byte>> decompress(std::span<const std::byte> tile, uint64_t bytes) {
  if (bytes / kMaxTileExpansion > tile.size()) return invalid_input("has not the points that the hierarchy states");
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
  std::vector<std::byte> records(bytes);
  ZSTD_inBuffer in{tile.data(), tile.size(), 0};
  ZSTD_outBuffer out{records.data(), records.size(), 0};
  size_t left = 1;
  while (left != 0 && (in.pos < in.size || out.pos < out.size)) {
    const size_t before = in.pos + out.pos;
    left = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(left) != 0) {
      return invalid_input(std::string("is damaged: ") + ZSTD_getErrorName(left));
    }
    if (in.pos + out.pos == before) break;
  }
  if (left != 0 || out.pos != out.size) return invalid_input("has not the points that the hierarchy states");
  return records;
}

}  // namespace

size_t EptDescription::record_bytes() const {
  size_t bytes = 0;
  for (const EptDimension& dimension : schema) bytes += size_of(dimension.type);
  return bytes;
}

Result<EptDescription> parse_ept(std::span<const std::byte> bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object()) return invalid_input("is no JSON object");
  EptDescription ept;
  const std::string coding = text_of(json, "dataType");
  if (coding != "laszip" && coding != "binary" && coding != "zstandard") {
    return fail(ErrorKind::kUnsupported, "EPT data of type " + printable(coding) + " is not supported");
  }
  ept.coding = coding == "laszip" ? EptCoding::kLaz : coding == "binary" ? EptCoding::kBinary : EptCoding::kZstandard;
  const auto bounds = numbers_of(json, "bounds", 6);
  if (!bounds) return invalid_input("the EPT bounds are missing");
  ept.cube.min = {(*bounds)[0], (*bounds)[1], (*bounds)[2]};
  ept.cube.max = {(*bounds)[3], (*bounds)[4], (*bounds)[5]};
  if (const auto own = numbers_of(json, "boundsConforming", 6)) {
    ept.conforming.min = {(*own)[0], (*own)[1], (*own)[2]};
    ept.conforming.max = {(*own)[3], (*own)[4], (*own)[5]};
  }
  ept.span = number_of(json, "span", 0);
  if (Status status = parse_schema(json, ept); !status) return fail(status);
  ept.crs = crs_of(member(json, "srs"));
  return ept;
}

std::string ept_name(const EptKey& key) {
  return std::to_string(key[0]) + '-' + std::to_string(key[1]) + '-' + std::to_string(key[2]) + '-' +
         std::to_string(key[3]);
}

std::string ept_tile_name(const EptDescription& ept, const EptKey& key) {
  constexpr std::array kExtensions{".laz", ".bin", ".zst"};
  return "ept-data/" + ept_name(key) + kExtensions.at(static_cast<size_t>(ept.coding));
}

Result<EptNodes> read_ept_nodes(const EptDescription& ept, const FileFolder& folder, const geometry::Zone& zone,
                                uint64_t most_bytes) {
  EptNodes nodes;
  std::vector<EptKey> pages{{0, 0, 0, 0}};
  std::set<EptKey> seen;
  while (!pages.empty()) {
    const std::vector<EptKey> depth = std::exchange(pages, {});
    std::vector<std::string> names;
    names.reserve(depth.size());
    for (const EptKey& key : depth) names.push_back(page_name(key));
    folder.prefetch(names);
    for (const EptKey& key : depth) {
      if (!seen.insert(key).second) {
        return invalid_input("a page of the EPT hierarchy is within itself: " + ept_name(key));
      }
      const Result<std::vector<std::byte>> bytes = folder.read(page_name(key), most_bytes);
      if (!bytes) return fail(bytes);
      most_bytes -= bytes->size();
      const Status taken = take_page(ept, *bytes, zone, nodes, pages);
      if (!taken) return fail_about(page_name(key), taken);
    }
  }
  return nodes;
}

Result<EptColumns> ept_columns(const EptDescription& ept, std::span<const std::byte> tile) {
  if (ept.coding != EptCoding::kLaz) return EptColumns{binary_columns(ept), binary_grid(ept)};
  const auto rows = las_rows(tile);
  if (!rows) return fail(rows);
  return EptColumns{(*rows)->columns(), (*rows)->traits().grid};
}

Result<PointTable> ept_points(const EptDescription& ept, std::span<const ColumnInfo> columns,
                              std::span<const std::byte> tile, uint64_t count) {
  if (ept.coding == EptCoding::kLaz) {
    const auto rows = las_rows(tile);
    if (!rows) return fail(rows);
    if (!std::ranges::equal((*rows)->columns(), columns)) {
      return invalid_input("has not the attributes of the other tiles");
    }
    return all_rows(**rows);
  }
  const uint64_t bytes = count * ept.record_bytes();
  if (ept.coding == EptCoding::kBinary) {
    if (tile.size() != bytes) return invalid_input("has not the points that the hierarchy states");
    return binary_table(ept, {tile.begin(), tile.end()});
  }
  return decompress(tile, bytes).map([&](std::vector<std::byte> records) {
    return binary_table(ept, std::move(records));
  });
}

}  // namespace surfcast::scan
