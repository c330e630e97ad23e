#include "scan/pcd_header.h"

#include <array>
#include <limits>
#include <string_view>

#include "base/invalid_input.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

/// More values per point than any file has. The limit bounds the memory that a malicious header can request.
constexpr size_t kMaxValues = 4096;

using Words = std::vector<std::string_view>;

/// The lines of the header by keyword, unparsed.
struct RawHeader {
  Words fields;
  Words sizes;
  Words types;
  Words counts;
  Words width;
  Words height;
  Words viewpoint;
  Words points;
  Words data;
};

Words* line_of(RawHeader& raw, std::string_view keyword) {
  if (keyword == "FIELDS" || keyword == "COLUMNS") return &raw.fields;
  if (keyword == "SIZE") return &raw.sizes;
  if (keyword == "TYPE") return &raw.types;
  if (keyword == "COUNT") return &raw.counts;
  if (keyword == "WIDTH") return &raw.width;
  if (keyword == "HEIGHT") return &raw.height;
  if (keyword == "VIEWPOINT") return &raw.viewpoint;
  if (keyword == "POINTS") return &raw.points;
  if (keyword == "DATA") return &raw.data;
  return nullptr;
}

/// Splits the header into lines. `offset` becomes the start of the line after DATA.
Result<RawHeader> split_header(std::string_view text, size_t& offset) {
  RawHeader raw;
  for (offset = 0; offset < text.size() && raw.data.empty();) {
    const size_t end = std::min(text.find('\n', offset), text.size());
    Tokens tokens(text.substr(offset, end - offset));
    const std::string_view keyword = tokens.next();
    offset = std::min(end + 1, text.size());
    if (keyword.empty() || keyword.starts_with('#') || keyword == "VERSION") continue;
    Words* line = line_of(raw, keyword);
    if (line == nullptr) return invalid_input("PCD header line not understood: " + printable(keyword));
    line->clear();
    for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) line->push_back(word);
  }
  if (raw.data.empty()) return invalid_input("PCD header has no DATA line");
  return raw;
}

std::optional<ScalarType> type_of(std::string_view type, std::string_view size) {
  if (type.size() != 1 || size.size() != 1) return std::nullopt;
  constexpr std::string_view kSizes = "1248";
  const size_t power = kSizes.find(size[0]);
  if (power == std::string_view::npos) return std::nullopt;
  constexpr std::array kUnsigned = {ScalarType::kUint8, ScalarType::kUint16, ScalarType::kUint32, ScalarType::kUint64};
  constexpr std::array kSigned = {ScalarType::kInt8, ScalarType::kInt16, ScalarType::kInt32, ScalarType::kInt64};
  if (type == "U") return kUnsigned[power];
  if (type == "I") return kSigned[power];
  if (type == "F" && size == "4") return ScalarType::kFloat32;
  if (type == "F" && size == "8") return ScalarType::kFloat64;
  return std::nullopt;
}

Status parse_fields(const RawHeader& raw, PcdHeader& header) {
  const size_t count = raw.fields.size();
  if (count == 0) return invalid_input("PCD header has no FIELDS line");
  if (raw.sizes.size() != count || raw.types.size() != count || (!raw.counts.empty() && raw.counts.size() != count)) {
    return invalid_input("PCD header lines FIELDS, SIZE, TYPE and COUNT differ in length");
  }
  size_t values = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto type = type_of(raw.types[i], raw.sizes[i]);
    const auto repeat = raw.counts.empty() ? std::optional<uint32_t>(1) : parse_number<uint32_t>(raw.counts[i]);
    if (!type || !repeat || *repeat > kMaxValues) {
      return invalid_input("PCD field " + printable(raw.fields[i]) + " has a type, size or count that is not known");
    }
    values += *repeat;
    header.fields.push_back({std::string(raw.fields[i]), *type, *repeat});
  }
  if (values > kMaxValues) return invalid_input("PCD header states too many values for each point");
  return {};
}

std::optional<uint64_t> number_in(const Words& line) {
  return line.size() == 1 ? parse_number<uint64_t>(line[0]) : std::nullopt;
}

Status parse_size(const RawHeader& raw, PcdHeader& header) {
  const std::optional<uint64_t> width = number_in(raw.width);
  const std::optional<uint64_t> height = number_in(raw.height);
  header.organised = height.value_or(1) > 1;
  if (const std::optional<uint64_t> points = number_in(raw.points)) {
    header.points = *points;
  } else if (width && height && (*height == 0 || *width <= std::numeric_limits<uint64_t>::max() / *height)) {
    header.points = *width * *height;
  } else {
    return invalid_input("PCD header does not state the number of points");
  }
  return {};
}

std::optional<glm::dvec3> parse_sensor(const Words& viewpoint, bool organised) {
  std::array<double, 7> numbers = {0, 0, 0, 1, 0, 0, 0};  // position, then a quaternion with w first
  if (viewpoint.size() == numbers.size()) {
    for (size_t i = 0; i < numbers.size(); ++i) {
      const std::optional<double> number = parse_number<double>(viewpoint[i]);
      if (!number) return std::nullopt;
      numbers[i] = *number;
    }
  }
  const glm::dvec3 position(numbers[0], numbers[1], numbers[2]);
  const bool turned = numbers[4] != 0 || numbers[5] != 0 || numbers[6] != 0;
  if (position == glm::dvec3(0) && !turned && !organised) return std::nullopt;
  return position;
}

std::optional<PcdEncoding> parse_encoding(const Words& data) {
  if (data[0] == "ascii") return PcdEncoding::kAscii;
  if (data[0] == "binary") return PcdEncoding::kBinary;
  if (data[0] == "binary_compressed") return PcdEncoding::kBinaryCompressed;
  return std::nullopt;
}

}  // namespace

size_t PcdHeader::record_length() const {
  size_t length = 0;
  for (const PcdField& field : fields) length += field.bytes();
  return length;
}

Result<PcdHeader> parse_pcd_header(std::span<const std::byte> bytes) {
  PcdHeader header;
  const Result<RawHeader> raw = split_header(as_text(bytes), header.data_offset);
  if (!raw) return fail(raw);
  if (Status status = parse_fields(*raw, header); !status) return fail(status);
  if (Status status = parse_size(*raw, header); !status) return fail(status);
  header.sensor = parse_sensor(raw->viewpoint, header.organised);
  const std::optional<PcdEncoding> encoding = parse_encoding(raw->data);
  if (!encoding) return invalid_input("PCD data is neither ascii, binary nor binary_compressed");
  header.encoding = *encoding;
  if (header.record_length() == 0) return invalid_input("PCD header states no values for its points");
  if (header.points == 0) return invalid_input("has no points");
  return header;
}

}  // namespace surfcast::scan
