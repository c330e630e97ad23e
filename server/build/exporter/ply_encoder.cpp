#include <array>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "exporter/point_encoders.h"
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

class PlyEncoder : public PointEncoder {
 public:
  PlyEncoder(scan::ScanSchema schema, uint64_t count) : schema_(std::move(schema)), count_(count) {}

  std::vector<std::byte> head() override {
    const std::string header = ply_header(schema_, count_);
    const auto bytes = std::as_bytes(std::span(header));
    return {bytes.begin(), bytes.end()};
  }
  Result<std::vector<std::byte>> rows(const scan::ScanPoints& points) override {
    return packed_rows(table_of(points, schema_), /*wide_integers=*/false);
  }

 private:
  scan::ScanSchema schema_;
  uint64_t count_;
};

}  // namespace

std::unique_ptr<PointEncoder> make_ply_encoder(scan::ScanSchema schema, uint64_t count) {
  return std::make_unique<PlyEncoder>(std::move(schema), count);
}

}  // namespace surfcast::exporter
