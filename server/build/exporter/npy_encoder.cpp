#include <array>
#include <string>
#include <utility>

#include "exporter/las_bytes.h"
#include "exporter/point_encoders.h"
#include "exporter/table_format.h"

namespace surfcast::exporter {
namespace {

const char* numpy_type(scan::ScalarType type) {
  constexpr std::array kNames = {"|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8"};
  return kNames.at(static_cast<size_t>(type));
}

/// A name between quotes of Python, in ASCII.
std::string numpy_name(const std::string& name) {
  std::string text = "'";
  for (const char c : name) text += c < ' ' || c > '~' || c == '\'' || c == '\\' ? '_' : c;
  return text + "'";
}

std::string numpy_description(const scan::ScanSchema& schema, uint64_t count) {
  std::string text = "{'descr': [";
  for (const scan::ColumnInfo& column : columns_of(schema)) {
    text += "(" + numpy_name(column.name) + ", '" + numpy_type(column.type) + "'), ";
  }
  return text + "], 'fortran_order': False, 'shape': (" + std::to_string(count) + ",), }";
}

class NpyEncoder : public PointEncoder {
 public:
  NpyEncoder(scan::ScanSchema schema, uint64_t count) : schema_(std::move(schema)), count_(count) {}

  std::vector<std::byte> head() override {
    constexpr size_t kAlignment = 64;  // of the rows
    constexpr size_t kBeforeText = 10;
    std::string text = numpy_description(schema_, count_);
    while ((kBeforeText + text.size() + 1) % kAlignment != 0) text += ' ';
    text += '\n';
    std::vector<std::byte> bytes(8);
    put_text(bytes, 0, "\x93NUMPY\x01");
    add(bytes, static_cast<uint16_t>(text.size()));
    add_bytes(bytes, std::as_bytes(std::span(text)));
    return bytes;
  }
  Result<std::vector<std::byte>> rows(const scan::ScanPoints& points) override {
    return packed_rows(table_of(points, schema_), /*wide_integers=*/true);
  }

 private:
  scan::ScanSchema schema_;
  uint64_t count_;
};

}  // namespace

std::unique_ptr<PointEncoder> make_npy_encoder(scan::ScanSchema schema, uint64_t count) {
  return std::make_unique<NpyEncoder>(std::move(schema), count);
}

}  // namespace surfcast::exporter
