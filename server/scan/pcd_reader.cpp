#include "scan/pcd_reader.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scan/lzf.h"
#include "scan/pcd_header.h"
#include "scan/point_table.h"
#include "scan/text_tokens.h"

namespace surfcast {
namespace {

using Bytes = std::span<const std::byte>;

tl::unexpected<Error> truncated(const PcdHeader& header) {
  return fail(ErrorKind::kInvalidInput,
              "truncated: the file ends before its " + std::to_string(header.points) + " points do");
}

std::string value_name(const PcdField& field, size_t value) {
  return field.count == 1 ? field.name : field.name + "_" + std::to_string(value);
}

/// Adds the columns of a field whose values for point 0 begin at `first`, and for every next point `stride` on.
void add_field(const PcdField& field, const std::byte* first, size_t stride, PointTable& table) {
  if (field.name == "_") return;
  for (size_t value = 0; value < field.count; ++value) {
    table.columns.push_back({value_name(field, value), field.type, first + value * size_of(field.type), stride, false});
  }
}

Result<PointTable> read_binary(const PcdHeader& header, Bytes data) {
  const size_t length = header.record_length();
  if (header.points > data.size() / length) return truncated(header);
  PointTable table;
  table.rows = header.points;
  size_t offset = 0;
  for (const PcdField& field : header.fields) {
    add_field(field, data.data() + offset, length, table);
    offset += field.bytes();
  }
  return table;
}

/// Two sizes, then LZF data that expands to all values of the first field, all of the second, and so on.
Result<PointTable> read_compressed(const PcdHeader& header, Bytes data) {
  if (data.size() < 2 * sizeof(uint32_t)) return truncated(header);
  const auto compressed = load<uint32_t>(data.data());
  const auto expanded = load<uint32_t>(data.data() + sizeof(uint32_t));
  data = data.subspan(2 * sizeof(uint32_t));
  if (compressed > data.size()) return truncated(header);
  const size_t length = header.record_length();
  if (expanded % length != 0 || expanded / length != header.points) {
    return fail(ErrorKind::kInvalidInput, "PCD compressed data is not of the size that the header states");
  }
  std::optional<std::vector<uint8_t>> values = decompress_lzf(data.first(compressed), expanded);
  if (!values) return fail(ErrorKind::kInvalidInput, "PCD compressed data is damaged");
  PointTable table;
  table.rows = header.points;
  const auto* first = reinterpret_cast<const std::byte*>(values->data());
  for (const PcdField& field : header.fields) {
    add_field(field, first, field.bytes(), table);
    first += field.bytes() * header.points;
  }
  table.storage.emplace_back(std::move(*values));
  return table;
}

Result<PointTable> read_ascii(const PcdHeader& header, Bytes data) {
  std::vector<ScalarValues> columns;
  std::vector<std::string> names;
  for (const PcdField& field : header.fields) {
    for (size_t value = 0; value < field.count; ++value) {
      columns.push_back(empty_values(field.type));
      names.push_back(value_name(field, value));
    }
  }
  Tokens tokens(as_text(data));
  for (uint64_t point = 0; point < header.points; ++point) {
    for (ScalarValues& column : columns) {
      const std::string_view word = tokens.next();
      if (word.empty()) return truncated(header);
      if (append_number(column, word)) continue;
      return fail(ErrorKind::kInvalidInput, "PCD value is not a number of its field's type: " + printable(word));
    }
  }
  PointTable table;
  table.rows = header.points;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (!names[i].starts_with("_")) add_column(table, names[i], std::move(columns[i]));
  }
  return table;
}

Result<PointTable> read_table(const PcdHeader& header, Bytes data) {
  switch (header.encoding) {
    case PcdEncoding::kAscii:
      return read_ascii(header, data);
    case PcdEncoding::kBinary:
      return read_binary(header, data);
    case PcdEncoding::kBinaryCompressed:
      break;
  }
  return read_compressed(header, data);
}

}  // namespace

Result<ScanPoints> read_pcd(Bytes bytes) {
  const Result<PcdHeader> header = parse_pcd_header(bytes);
  if (!header) return fail(header.error());
  const Result<PointTable> table = read_table(*header, bytes.subspan(header->data_offset));
  if (!table) return fail(table.error());
  Result<ScanPoints> points = points_from_table(*table);
  if (!points) return points;
  points->sensor = header->sensor;
  points->z_up = !header->organised;
  return points;
}

}  // namespace surfcast
