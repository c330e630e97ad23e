#include <array>
#include <charconv>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "exporter/point_encoders.h"
#include "exporter/table_format.h"

namespace surfcast::exporter {
namespace {

std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

void append_value(std::string& text, const scan::Column& column, size_t row) {
  scan::with_type(column.type, [&](auto zero) {
    const auto value = scan::load<decltype(zero)>(column.first + row * column.stride);
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text.append(digits.data(), end);
  });
}

std::string lines_of(const scan::PointTable& table) {
  std::string text;
  for (size_t row = 0; row < table.rows; ++row) {
    for (size_t i = 0; i < table.columns.size(); ++i) {
      if (i > 0) text += ',';
      append_value(text, table.columns[i], row);
    }
    text += '\n';
  }
  return text;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

class CsvEncoder : public PointEncoder {
 public:
  explicit CsvEncoder(scan::ScanSchema schema) : schema_(std::move(schema)) {}

  std::vector<std::byte> head() override {
    std::string names;
    for (const scan::ColumnInfo& column : columns_of(schema_))
      names += (names.empty() ? "" : ",") + quoted(column.name);
    return bytes_of(names + '\n');
  }
  Result<std::vector<std::byte>> rows(const scan::ScanPoints& points) override {
    return bytes_of(lines_of(table_of(points, schema_)));
  }

 private:
  scan::ScanSchema schema_;
};

}  // namespace

std::unique_ptr<PointEncoder> make_csv_encoder(scan::ScanSchema schema) {
  return std::make_unique<CsvEncoder>(std::move(schema));
}

}  // namespace surfcast::exporter
