#include "model/draco_table.h"

#include <memory>
#include <string>

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud.h>

#include "base/contract.h"
#include "model/byte_stream.h"

namespace surfcast {
namespace {

/// Draco's 0 is the smallest and slowest, 10 the largest and fastest; docs/model-format.md has the measurement.
constexpr int kDracoSpeed = 4;

draco::DataType data_type(uint8_t bytes) {
  return bytes == 1 ? draco::DT_UINT8 : bytes == 2 ? draco::DT_UINT16 : draco::DT_UINT32;
}

template <typename T>
void store(const TableColumn& column, draco::PointAttribute& attribute) {
  for (size_t i = 0; i < column.values.size(); ++i) {
    const auto value = static_cast<T>(column.values[i]);
    attribute.SetAttributeValue(draco::AttributeValueIndex(static_cast<uint32_t>(i)), &value);
  }
}

std::unique_ptr<draco::PointAttribute> make_attribute(const TableColumn& column) {
  draco::GeometryAttribute description;
  description.Init(draco::GeometryAttribute::GENERIC, nullptr, 1, data_type(column.bytes), false, column.bytes, 0);
  auto attribute = std::make_unique<draco::PointAttribute>(description);
  attribute->SetIdentityMapping();
  attribute->Reset(column.values.size());
  if (column.bytes == 1) store<uint8_t>(column, *attribute);
  if (column.bytes == 2) store<uint16_t>(column, *attribute);
  if (column.bytes == 4) store<uint32_t>(column, *attribute);
  return attribute;
}

template <typename T>
void load(const draco::PointAttribute& attribute, uint32_t rows, std::vector<uint32_t>& values) {
  values.resize(rows);
  for (uint32_t i = 0; i < rows; ++i) {
    T value{};
    attribute.GetMappedValue(draco::PointIndex(i), &value);
    values[i] = value;
  }
}

/// Number of points as the stream's header states it; Draco allocates by it, so it is checked first. Layout of the
/// header (Draco bitstream 2.3): "DRACO", version 2 bytes, encoder type, method, flags 2 bytes, points in 32 bits.
bool states_rows(std::span<const std::byte> bytes, uint32_t rows) {
  constexpr uint16_t kMetadataFlag = 0x8000;
  ByteReader reader(bytes);
  reader.get_bytes(7);
  const auto type = reader.get<uint8_t>();
  reader.get<uint8_t>();
  const auto flags = reader.get<uint16_t>();
  const auto points = reader.get<uint32_t>();
  return reader.ok() && type == draco::POINT_CLOUD && (flags & kMetadataFlag) == 0 && points == rows;
}

bool holds(const draco::PointAttribute& attribute, uint8_t width, uint32_t rows) {
  return attribute.data_type() == data_type(width) && attribute.num_components() == 1 &&
         attribute.byte_stride() == width && attribute.is_mapping_identity() && attribute.size() >= rows &&
         attribute.buffer()->data_size() >= size_t{width} * rows;
}

TableColumn load_column(const draco::PointAttribute& attribute, uint8_t width, uint32_t rows) {
  TableColumn column{width, {}};
  if (width == 1) load<uint8_t>(attribute, rows, column.values);
  if (width == 2) load<uint16_t>(attribute, rows, column.values);
  if (width == 4) load<uint32_t>(attribute, rows, column.values);
  return column;
}

}  // namespace

std::vector<std::byte> encode_table(std::span<const TableColumn> columns) {
  draco::PointCloud cloud;
  cloud.set_num_points(static_cast<uint32_t>(columns.front().values.size()));
  for (const TableColumn& column : columns) cloud.AddAttribute(make_attribute(column));
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_KD_TREE_ENCODING);
  encoder.SetSpeedOptions(kDracoSpeed, kDracoSpeed);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodePointCloudToBuffer(cloud, &buffer);
  SURFCAST_EXPECTS(status.ok());
  const std::span<const std::byte> bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return {bytes.begin(), bytes.end()};
}

Result<std::vector<TableColumn>> decode_table(std::span<const std::byte> bytes, std::span<const uint8_t> widths,
                                              uint32_t rows) {
  if (!states_rows(bytes, rows)) return fail(ErrorKind::kInvalidInput, "its Draco data has another number of surfels");
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodePointCloudFromBuffer(&buffer);
  if (!decoded.ok()) return fail(ErrorKind::kInvalidInput, "Draco: " + decoded.status().error_msg_string());
  const std::unique_ptr<draco::PointCloud> cloud = std::move(decoded).value();
  if (cloud->num_points() != rows || cloud->num_attributes() != static_cast<int>(widths.size())) {
    return fail(ErrorKind::kInvalidInput, "its Draco data has another shape");
  }
  std::vector<TableColumn> columns;
  for (size_t i = 0; i < widths.size(); ++i) {
    const draco::PointAttribute& attribute = *cloud->attribute(static_cast<int>(i));
    if (!holds(attribute, widths[i], rows)) return fail(ErrorKind::kInvalidInput, "its Draco data has another type");
    columns.push_back(load_column(attribute, widths[i], rows));
  }
  return columns;
}

}  // namespace surfcast
