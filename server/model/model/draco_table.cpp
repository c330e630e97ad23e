#include "model/draco_table.h"

#include <memory>
#include <string>

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud.h>

#include "base/contract.h"
#include "model/byte_stream.h"

namespace surfcast::model {
namespace {

/// Draco's speed 0 gives the smallest data and is slowest, 10 the largest and fastest; docs/model-format.md has the
/// measurement.
constexpr int kDracoSpeed = 5;

draco::DataType data_type(uint8_t bytes) {
  return bytes == 1 ? draco::DT_UINT8 : draco::DT_UINT16;
}

std::unique_ptr<draco::PointAttribute> make_attribute(const TableAttribute& table) {
  const auto [bytes, components] = table.type;
  draco::GeometryAttribute description;
  description.Init(draco::GeometryAttribute::GENERIC, nullptr, static_cast<int8_t>(components), data_type(bytes), false,
                   int64_t{bytes} * components, 0);
  auto attribute = std::make_unique<draco::PointAttribute>(description);
  attribute->SetIdentityMapping();
  attribute->Reset(table.rows());
  if (bytes == 1) {
    const std::vector<uint8_t> narrow(table.values.begin(), table.values.end());
    attribute->buffer()->Write(0, narrow.data(), narrow.size());
  } else {
    attribute->buffer()->Write(0, table.values.data(), table.values.size() * sizeof(uint16_t));
  }
  return attribute;
}

/// True if Draco's attribute declarations match: one group of attributes. Each has its kind, type, number of
/// components, a normalized flag and its ID; then follows the coding method of each.
bool states_attributes(ByteReader& reader, std::span<const TableType> types) {
  constexpr uint8_t kIntegers = 1;
  if (reader.get<uint8_t>() != 1 || reader.get_varint() != types.size()) return false;
  for (const TableType& type : types) {
    reader.get<uint8_t>();
    if (reader.get<uint8_t>() != data_type(type.bytes) || reader.get<uint8_t>() != type.components) return false;
    reader.get<uint8_t>();
    reader.get_varint();
  }
  for (size_t i = 0; i < types.size(); ++i) {
    if (reader.get<uint8_t>() != kIntegers) return false;
  }
  return reader.ok();
}

/// "DRACO", version in 2 bytes, encoder type, method, flags in 2 bytes, number of points in 4 (Draco bitstream 2.3).
constexpr size_t kDracoHeadBytes = 15;

/// True if Draco's header and attribute declarations describe this table. Checked before decoding, because Draco
/// allocates memory by them.
bool states_table(std::span<const std::byte> bytes, std::span<const TableType> types, uint32_t rows) {
  constexpr uint16_t kMetadataFlag = 0x8000;
  ByteReader reader(bytes);
  reader.get_bytes(7);
  const auto type = reader.get<uint8_t>();
  const auto method = reader.get<uint8_t>();
  const auto flags = reader.get<uint16_t>();
  const auto points = reader.get<uint32_t>();
  return type == draco::POINT_CLOUD && method == draco::POINT_CLOUD_SEQUENTIAL_ENCODING &&
         (flags & kMetadataFlag) == 0 && points == rows && states_attributes(reader, types);
}

/// The bytes of a table that declares only the first attributes. The data of attributes are contiguous and coded
/// independently, so Draco does not read the data after the last declared attribute.
std::vector<std::byte> first_attributes(std::span<const std::byte> bytes, size_t wanted) {
  ByteReader reader(bytes);
  ByteWriter writer;
  writer.put_bytes(reader.get_bytes(kDracoHeadBytes));
  writer.put(reader.get<uint8_t>());
  const uint64_t all = reader.get_varint();
  writer.put_varint(wanted);
  for (size_t i = 0; i < all; ++i) {
    ByteWriter attribute;
    attribute.put_bytes(reader.get_bytes(4));
    attribute.put_varint(reader.get_varint());
    if (i < wanted) writer.put_bytes(attribute.bytes());
  }
  writer.put_bytes(reader.get_bytes(all).first(wanted));
  writer.put_bytes(reader.rest());
  return std::move(writer).take();
}

/// False if the table has implausibly many bytes. Draco accepts 64 symbols per remaining byte and allocates memory for
/// them. Its encoder does not exceed the size of the table: it stores values uncompressed where symbols would take
/// more.
bool plausible_size(std::span<const std::byte> bytes, std::span<const TableType> types, uint32_t rows) {
  constexpr size_t kHeads = 65536;
  size_t table = 0;
  for (const TableType& type : types) table += size_t{rows} * type.bytes * type.components;
  return bytes.size() <= 2 * table + kHeads;
}

bool holds(const draco::PointAttribute& attribute, const TableType& type, uint32_t rows) {
  const size_t stride = size_t{type.bytes} * type.components;
  return attribute.data_type() == data_type(type.bytes) && attribute.num_components() == type.components &&
         attribute.byte_stride() == static_cast<int64_t>(stride) && attribute.byte_offset() == 0 &&
         attribute.is_mapping_identity() && attribute.buffer()->data_size() >= stride * rows;
}

template <typename T>
std::vector<uint16_t> load(const draco::PointAttribute& attribute, size_t count) {
  std::vector<T> values(count);
  attribute.buffer()->Read(0, values.data(), count * sizeof(T));
  return {values.begin(), values.end()};
}

TableAttribute load_attribute(const draco::PointAttribute& attribute, const TableType& type, uint32_t rows) {
  const size_t count = size_t{rows} * type.components;
  return {type, type.bytes == 1 ? load<uint8_t>(attribute, count) : load<uint16_t>(attribute, count)};
}

}  // namespace

std::vector<std::byte> encode_table(std::span<const TableAttribute> attributes) {
  draco::PointCloud cloud;
  cloud.set_num_points(static_cast<uint32_t>(attributes.front().rows()));
  for (const TableAttribute& attribute : attributes) cloud.AddAttribute(make_attribute(attribute));
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(kDracoSpeed, kDracoSpeed);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodePointCloudToBuffer(cloud, &buffer);
  SURFCAST_EXPECTS(status.ok());
  const std::span<const std::byte> bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return {bytes.begin(), bytes.end()};
}

Result<std::vector<TableAttribute>> decode_table(std::span<const std::byte> bytes, std::span<const TableType> types,
                                                 uint32_t rows, size_t wanted) {
  SURFCAST_EXPECTS(wanted <= types.size());
  if (!states_table(bytes, types, rows)) return fail(ErrorKind::kInvalidInput, "its Draco data states another shape");
  if (!plausible_size(bytes, types, rows)) return fail(ErrorKind::kInvalidInput, "its Draco data is too long");
  if (wanted == 0) return std::vector<TableAttribute>();
  const std::vector<std::byte> shortened =
      wanted < types.size() ? first_attributes(bytes, wanted) : std::vector<std::byte>();
  if (!shortened.empty()) bytes = shortened;
  types = types.first(wanted);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodePointCloudFromBuffer(&buffer);
  if (!decoded.ok()) return fail(ErrorKind::kInvalidInput, "Draco: " + decoded.status().error_msg_string());
  const std::unique_ptr<draco::PointCloud> cloud = std::move(decoded).value();
  if (cloud->num_points() != rows || cloud->num_attributes() != static_cast<int>(types.size())) {
    return fail(ErrorKind::kInvalidInput, "its Draco data has another shape");
  }
  std::vector<TableAttribute> attributes;
  for (size_t i = 0; i < types.size(); ++i) {
    const draco::PointAttribute& attribute = *cloud->attribute(static_cast<int>(i));
    if (!holds(attribute, types[i], rows)) return fail(ErrorKind::kInvalidInput, "its Draco data has another type");
    attributes.push_back(load_attribute(attribute, types[i], rows));
  }
  return attributes;
}

}  // namespace surfcast::model
