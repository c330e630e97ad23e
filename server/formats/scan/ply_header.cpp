#include "scan/ply_header.h"

#include <charconv>
#include <string_view>
#include <utility>

#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

constexpr std::pair<std::string_view, ScalarType> kTypeNames[] = {
    {"char", ScalarType::kInt8},       {"int8", ScalarType::kInt8},      {"uchar", ScalarType::kUint8},
    {"uint8", ScalarType::kUint8},     {"short", ScalarType::kInt16},    {"int16", ScalarType::kInt16},
    {"ushort", ScalarType::kUint16},   {"uint16", ScalarType::kUint16},  {"int", ScalarType::kInt32},
    {"int32", ScalarType::kInt32},     {"uint", ScalarType::kUint32},    {"uint32", ScalarType::kUint32},
    {"int64", ScalarType::kInt64},     {"uint64", ScalarType::kUint64},  {"float", ScalarType::kFloat32},
    {"float32", ScalarType::kFloat32}, {"double", ScalarType::kFloat64}, {"float64", ScalarType::kFloat64},
};

std::optional<ScalarType> type_named(std::string_view name) {
  for (const auto& [known, type] : kTypeNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

tl::unexpected<Error> bad_line(std::string_view line) {
  return fail(ErrorKind::kInvalidInput, "PLY header line not understood: " + printable(line));
}

/// Iterates over the lines of the header. The end of the first line determines the line ending (LF, CR LF or CR).
/// Without this rule, a CR before binary data could swallow a first data byte of 10.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view text) : text_(text) {
    const size_t end = text.find_first_of("\r\n");
    if (end == std::string_view::npos) return;
    terminator_ = text.substr(end, text.substr(end, 2) == "\r\n" ? 2 : 1);
  }
  std::optional<std::string_view> next() {
    const size_t end = text_.find(terminator_, at_);
    if (terminator_.empty() || end == std::string_view::npos) return std::nullopt;
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = end + terminator_.size();
    return line;
  }
  [[nodiscard]] size_t offset() const { return at_; }

 private:
  std::string_view text_;
  std::string_view terminator_;
  size_t at_ = 0;
};

Status parse_format(std::string_view line, Tokens tokens, PlyHeader& header) {
  const std::string_view encoding = tokens.next();
  if (encoding == "ascii") {
    header.encoding = PlyEncoding::kAscii;
  } else if (encoding == "binary_little_endian") {
    header.encoding = PlyEncoding::kBinaryLittleEndian;
  } else if (encoding == "binary_big_endian") {
    header.encoding = PlyEncoding::kBinaryBigEndian;
  } else {
    return bad_line(line);
  }
  return {};
}

Status parse_element(std::string_view line, Tokens tokens, PlyHeader& header) {
  PlyElement element;
  element.name = tokens.next();
  const std::optional<uint64_t> count = parse_number<uint64_t>(tokens.next());
  if (element.name.empty() || !count) return bad_line(line);
  element.count = *count;
  header.elements.push_back(std::move(element));
  return {};
}

Status parse_property(std::string_view line, Tokens tokens, PlyHeader& header) {
  PlyProperty property;
  std::string_view word = tokens.next();
  if (word == "list") {
    property.list_count = type_named(tokens.next());
    if (!property.list_count || is_floating(*property.list_count)) return bad_line(line);
    word = tokens.next();
  }
  const std::optional<ScalarType> type = type_named(word);
  property.name = tokens.next();
  if (!type || property.name.empty() || header.elements.empty()) return bad_line(line);
  property.type = *type;
  header.elements.back().properties.push_back(std::move(property));
  return {};
}

Status parse_line(std::string_view line, PlyHeader& header, bool& has_format) {
  Tokens tokens(line);
  const std::string_view keyword = tokens.next();
  if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return {};
  if (keyword == "format") {
    has_format = true;
    return parse_format(line, tokens, header);
  }
  if (keyword == "element") return parse_element(line, tokens, header);
  if (keyword == "property") return parse_property(line, tokens, header);
  return bad_line(line);
}

}  // namespace

Result<PlyHeader> parse_ply_header(std::span<const std::byte> bytes) {
  HeaderLines lines(as_text(bytes));
  PlyHeader header;
  bool has_format = false;
  lines.next();  // "ply"
  while (const std::optional<std::string_view> line = lines.next()) {
    if (Tokens(*line).next() == "end_header") {
      if (!has_format) return fail(ErrorKind::kInvalidInput, "PLY header has no format line");
      header.data_offset = lines.offset();
      return header;
    }
    if (Status status = parse_line(*line, header, has_format); !status) return fail(status);
  }
  return fail(ErrorKind::kInvalidInput, "PLY header has no end_header line");
}

}  // namespace surfcast::scan
