#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/invalid_input.h"
#include "scan/readers.h"
#include "scan/sliced_rows.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

constexpr uint64_t kMaxRecordBytes = 4096;
/// Lines of a header, at the very most.
constexpr int kMaxLines = 256;

/// A run of bytes in every record.
struct Property {
  std::string name;
  uint64_t bytes = 0;
};

struct ExpeHeader {
  std::vector<Property> properties;
  uint64_t points = 0;
  size_t data_offset = 0;

  [[nodiscard]] uint64_t record_bytes() const {
    uint64_t bytes = 0;
    for (const Property& property : properties) bytes += property.bytes;
    return bytes;
  }
};

Status parse_line(std::string_view line, ExpeHeader& header) {
  Tokens words(line);
  const std::string_view key = words.next();
  const std::string_view first = words.next();
  if (key == "nofpoints") {
    const auto points = parse_number<uint64_t>(first);
    if (!points) return invalid_input("Expe header: not a number of points: " + printable(first));
    header.points = *points;
  }
  if (key != "property") return {};
  const auto bytes = parse_number<uint64_t>(words.next());
  if (!bytes || *bytes > kMaxRecordBytes) return invalid_input("Expe header: no size of property " + printable(first));
  header.properties.push_back({std::string(first), *bytes});
  return {};
}

Result<ExpeHeader> parse_header(std::string_view text) {
  ExpeHeader header;
  size_t at = 0;
  for (int line = 0; line < kMaxLines; ++line) {
    const size_t end = text.find('\n', at);
    if (end == std::string_view::npos) return invalid_input("truncated: the file ends within its Expe header");
    std::string_view words = text.substr(at, end - at);
    if (words.ends_with('\r')) words.remove_suffix(1);
    at = end + 1;
    if (words == "data") {
      header.data_offset = at;
      return header;
    }
    if (Status status = parse_line(words, header); !status) return fail(status);
  }
  return invalid_input("the Expe header does not end");
}

/// The columns of a property; none for one that is skipped.
std::vector<ColumnInfo> columns_of(const Property& property) {
  constexpr auto kF32 = ScalarType::kFloat32;
  constexpr auto kU8 = ScalarType::kUint8;
  if (property.name == "position" && property.bytes == 12) return {{"x", kF32}, {"y", kF32}, {"z", kF32}};
  if (property.name == "radius" && property.bytes == 4) return {{"radius", kF32}};
  if (property.name == "normal" && property.bytes == 12) return {{"nx", kF32}, {"ny", kF32}, {"nz", kF32}};
  if (property.name == "color" && property.bytes == 4) {
    return {{"red", kU8}, {"green", kU8}, {"blue", kU8}, {"alpha", kU8}};
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<RowSource>> expe_rows(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  if (!text.starts_with("[Expe/PointSet/Binary/")) {
    return fail(ErrorKind::kUnsupported, "Expe point sets as text are not supported");
  }
  const Result<ExpeHeader> header = parse_header(text);
  if (!header) return fail(header);
  const uint64_t stride = header->record_bytes();
  if (stride == 0 || stride > kMaxRecordBytes) return invalid_input("the Expe header states no usable record");
  if (header->points > (bytes.size() - header->data_offset) / stride) {
    return invalid_input("truncated: the Expe header states " + std::to_string(header->points) + " points");
  }
  PointTable table;
  table.rows = header->points;
  std::vector<ColumnInfo> columns;
  const std::byte* first = bytes.data() + header->data_offset;
  for (const Property& property : header->properties) {
    size_t within = 0;
    for (const ColumnInfo& column : columns_of(property)) {
      table.columns.push_back({column.type, first + within, stride, false});
      within += size_of(column.type);
      columns.push_back(column);
    }
    first += property.bytes;
  }
  if (columns.empty() || table.rows == 0) return invalid_input("has no points");
  RowTraits traits;
  traits.may_be_graphics = true;
  return std::make_unique<SlicedRows>(traits, std::move(columns), std::move(table));
}

}  // namespace surfcast::scan
