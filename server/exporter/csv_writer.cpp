#include "exporter/csv_writer.h"

#include <array>
#include <charconv>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
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

class CsvWriter : public PointWriter {
 public:
  CsvWriter(AtomicFile file, scan::ScanSchema schema) : file_(std::move(file)), schema_(std::move(schema)) {}

  Status append(const scan::ScanPoints& points) override {
    written_ += points.size();
    const std::string lines = lines_of(table_of(points, schema_));
    return file_.append(std::as_bytes(std::span(lines)));
  }
  [[nodiscard]] uint64_t written() const override { return written_; }
  Result<uint64_t> finish() override {
    const uint64_t bytes = file_.position();
    return file_.commit().map([bytes] { return bytes; });
  }

 private:
  AtomicFile file_;
  scan::ScanSchema schema_;
  uint64_t written_ = 0;
};

}  // namespace

Result<std::unique_ptr<PointWriter>> create_csv(const std::filesystem::path& target, const scan::ScanSchema& schema) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(std::move(file.error()));
  std::string names;
  for (const scan::ColumnInfo& column : columns_of(schema)) names += (names.empty() ? "" : ",") + quoted(column.name);
  names += '\n';
  if (Status status = file->append(std::as_bytes(std::span(names))); !status) return fail(std::move(status.error()));
  return std::make_unique<CsvWriter>(std::move(*file), schema);
}

}  // namespace surfcast::exporter
