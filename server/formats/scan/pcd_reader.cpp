#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scan/lzf.h"
#include "scan/pcd_header.h"
#include "scan/point_table.h"
#include "scan/readers.h"
#include "scan/sliced_rows.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

using Bytes = std::span<const std::byte>;

tl::unexpected<Error> truncated(const PcdHeader& header) {
  return fail(ErrorKind::kInvalidInput,
              "truncated: the file ends before its " + std::to_string(header.points) + " points do");
}

std::string value_name(const PcdField& field, size_t value) {
  return field.count == 1 ? field.name : field.name + "_" + std::to_string(value);
}

bool is_padding(const PcdField& field) {
  return field.name == "_";
}

std::vector<ColumnInfo> columns_of(const PcdHeader& header) {
  std::vector<ColumnInfo> columns;
  for (const PcdField& field : header.fields) {
    for (size_t value = 0; !is_padding(field) && value < field.count; ++value) {
      columns.push_back({value_name(field, value), field.type, false});
    }
  }
  return columns;
}

RowTraits traits_of(const PcdHeader& header) {
  RowTraits traits;
  traits.sensor = header.sensor;
  traits.z_up = !header.organised;
  return traits;
}

/// Adds the columns of a field. Its values for point i begin at `first + i * stride`.
void add_field(const PcdField& field, const std::byte* first, size_t stride, PointTable& table) {
  for (size_t value = 0; !is_padding(field) && value < field.count; ++value) {
    table.columns.push_back({field.type, first + value * size_of(field.type), stride, false});
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

/// The data: two sizes, then LZF data that expands to all values of the first field, all of the second, and so on.
Result<PointTable> read_compressed(const PcdHeader& header, Bytes data, const DecodingLimit& limit) {
  if (data.size() < 2 * sizeof(uint32_t)) return truncated(header);
  const auto compressed = load<uint32_t>(data.data());
  const auto expanded = load<uint32_t>(data.data() + sizeof(uint32_t));
  data = data.subspan(2 * sizeof(uint32_t));
  if (compressed > data.size()) return truncated(header);
  const size_t length = header.record_length();
  if (expanded % length != 0 || expanded / length != header.points) {
    return fail(ErrorKind::kInvalidInput, "PCD compressed data is not of the size that the header states");
  }
  if (Status status = limit.check(expanded); !status) return fail(status);
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

/// Rows of words. The starts of the pieces are found in a first pass.
class AsciiRows : public RowSource {
 public:
  AsciiRows(const PcdHeader& header, std::vector<Tokens> starts)
      : header_(header), traits_(traits_of(header)), columns_(columns_of(header)), starts_(std::move(starts)) {}

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return starts_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    std::vector<surfel::ScalarValues> values;
    for (const ColumnInfo& column : columns_) values.push_back(empty_values(column.type));
    PointTable table;
    table.rows = std::min(kPieceRows, header_.points - piece * kPieceRows);
    Tokens tokens = starts_[piece];
    for (size_t row = 0; row < table.rows; ++row) {
      if (Status status = read_row(tokens, values); !status) return fail(status);
    }
    for (surfel::ScalarValues& column : values) add_column(table, std::move(column));
    return table;
  }

 private:
  Status read_row(Tokens& tokens, std::vector<surfel::ScalarValues>& values) const {
    size_t column = 0;
    for (const PcdField& field : header_.fields) {
      for (size_t value = 0; value < field.count; ++value) {
        const std::string_view word = tokens.next();
        if (is_padding(field) || append_number(values[column++], word)) continue;
        return fail(ErrorKind::kInvalidInput, "PCD value is not a number of its field's type: " + printable(word));
      }
    }
    return {};
  }

  PcdHeader header_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
  std::vector<Tokens> starts_;
};

Result<std::unique_ptr<RowSource>> ascii_rows(const PcdHeader& header, Bytes data) {
  size_t words = 0;
  for (const PcdField& field : header.fields) words += field.count;
  Tokens tokens(as_text(data));
  std::vector<Tokens> starts;
  for (uint64_t point = 0; point < header.points; ++point) {
    if (point % kPieceRows == 0) starts.push_back(tokens);
    for (size_t i = 0; i < words; ++i) {
      if (tokens.next().empty()) return truncated(header);
    }
  }
  return std::make_unique<AsciiRows>(header, std::move(starts));
}

}  // namespace

Result<std::unique_ptr<RowSource>> pcd_rows(Bytes bytes, const DecodingLimit& limit) {
  const Result<PcdHeader> header = parse_pcd_header(bytes);
  if (!header) return fail(header);
  const Bytes data = bytes.subspan(header->data_offset);
  if (header->encoding == PcdEncoding::kAscii) return ascii_rows(*header, data);
  Result<PointTable> table =
      header->encoding == PcdEncoding::kBinary ? read_binary(*header, data) : read_compressed(*header, data, limit);
  if (!table) return fail(table);
  return std::make_unique<SlicedRows>(traits_of(*header), columns_of(*header), std::move(*table));
}

}  // namespace surfcast::scan
