#include "exporter/ply_writer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "exporter/table_format.h"

namespace surfcast::exporter {
namespace {

using scan::ScalarType;

const char* ply_type(ScalarType type) {
  constexpr std::array kNames = {"uchar", "char",   "ushort", "short", "uint",
                                 "int",   "double", "double", "float", "double"};
  return kNames.at(static_cast<size_t>(type));
}

/// Names of properties end at spaces, comments at the ends of lines.
std::string without(std::string text, const char* forbidden, char instead) {
  for (char& c : text) {
    if (std::strchr(forbidden, c) != nullptr) c = instead;
  }
  return text;
}

std::string ply_header(const scan::ScanSchema& schema, uint64_t count) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by Surfcast\n";
  if (!schema.crs.empty()) header += "comment crs " + without(schema.crs, "\r\n", ' ') + "\n";
  header += "element vertex " + std::to_string(count) + "\n";
  for (const scan::ColumnInfo& column : columns_of(schema)) {
    header += std::string("property ") + ply_type(column.type) + " " + without(column.name, " \t\r\n", '_') + "\n";
  }
  return header + "end_header\n";
}

size_t stored_size(ScalarType type) {
  return type == ScalarType::kUint64 || type == ScalarType::kInt64 ? sizeof(double) : scan::size_of(type);
}

template <typename T>
void store_value(std::byte* at, T value) {
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
    const auto number = static_cast<double>(value);
    std::memcpy(at, &number, sizeof(number));
  } else {
    std::memcpy(at, &value, sizeof(value));
  }
}

/// The rows one after another, without padding.
std::vector<std::byte> packed(const scan::PointTable& table) {
  size_t length = 0;
  for (const scan::Column& column : table.columns) length += stored_size(column.type);
  std::vector<std::byte> rows(table.rows * length);
  size_t offset = 0;
  for (const scan::Column& column : table.columns) {
    scan::for_each_value(column, table.rows,
                         [&](size_t i, auto value) { store_value(&rows[i * length + offset], value); });
    offset += stored_size(column.type);
  }
  return rows;
}

class PlyWriter : public PointWriter {
 public:
  PlyWriter(AtomicFile file, scan::ScanSchema schema) : file_(std::move(file)), schema_(std::move(schema)) {}

  Status append(const scan::ScanPoints& points) override {
    written_ += points.size();
    return file_.append(packed(table_of(points, schema_)));
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

Result<std::unique_ptr<PointWriter>> create_ply(const std::filesystem::path& target, const scan::ScanSchema& schema,
                                                uint64_t count) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(std::move(file.error()));
  const std::string header = ply_header(schema, count);
  if (Status status = file->append(std::as_bytes(std::span(header))); !status) return fail(std::move(status.error()));
  return std::make_unique<PlyWriter>(std::move(*file), schema);
}

}  // namespace surfcast::exporter
