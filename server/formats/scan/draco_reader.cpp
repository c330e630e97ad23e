#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <draco/compression/decode.h>

#include "scan/draco_claims.h"
#include "scan/point_table.h"
#include "scan/readers.h"
#include "scan/sliced_rows.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

std::optional<ScalarType> scalar_type(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return ScalarType::kInt8;
    case draco::DT_UINT8:
    case draco::DT_BOOL:
      return ScalarType::kUint8;
    case draco::DT_INT16:
      return ScalarType::kInt16;
    case draco::DT_UINT16:
      return ScalarType::kUint16;
    case draco::DT_INT32:
      return ScalarType::kInt32;
    case draco::DT_UINT32:
      return ScalarType::kUint32;
    case draco::DT_INT64:
      return ScalarType::kInt64;
    case draco::DT_UINT64:
      return ScalarType::kUint64;
    case draco::DT_FLOAT32:
      return ScalarType::kFloat32;
    case draco::DT_FLOAT64:
      return ScalarType::kFloat64;
    default:
      return std::nullopt;
  }
}

/// The name of an attribute in the metadata, or one made from its number.
std::string generic_name(const draco::PointCloud& cloud, int id) {
  std::string name;
  const draco::AttributeMetadata* metadata = cloud.GetAttributeMetadataByAttributeId(id);
  if (metadata != nullptr && metadata->GetEntryString("name", &name) && !name.empty()) return printable(name);
  return "attribute_" + std::to_string(id);
}

std::string component_name(const draco::PointCloud& cloud, int id, size_t component) {
  constexpr std::array kPosition = {"x", "y", "z"};
  constexpr std::array kNormal = {"nx", "ny", "nz"};
  constexpr std::array kColor = {"red", "green", "blue", "alpha"};
  constexpr std::array kTexture = {"texture_u", "texture_v"};
  const auto pick = [&](const auto& names) {
    return component < names.size() ? std::string(names[component]) : generic_name(cloud, id);
  };
  const draco::PointAttribute& attribute = *cloud.attribute(id);
  switch (attribute.attribute_type()) {
    case draco::GeometryAttribute::POSITION:
      return pick(kPosition);
    case draco::GeometryAttribute::NORMAL:
      return pick(kNormal);
    case draco::GeometryAttribute::COLOR:
      return pick(kColor);
    case draco::GeometryAttribute::TEX_COORD:
      return pick(kTexture);
    default:
      break;
  }
  const std::string name = generic_name(cloud, id);
  return attribute.num_components() == 1 ? name : name + "_" + std::to_string(component);
}

/// One component of an attribute for every point. None if a point refers to a value that does not exist.
template <typename T>
std::optional<std::vector<T>> component_values(const draco::PointCloud& cloud, const draco::PointAttribute& attribute,
                                               size_t component) {
  std::vector<T> values(cloud.num_points());
  for (uint32_t i = 0; i < cloud.num_points(); ++i) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(i));
    if (index.value() >= attribute.size()) return std::nullopt;
    values[i] = load<T>(reinterpret_cast<const std::byte*>(attribute.GetAddress(index)) + component * sizeof(T));
  }
  return values;
}

Status add_attribute(const draco::PointCloud& cloud, int id, std::vector<ColumnInfo>& columns, PointTable& table) {
  const draco::PointAttribute& attribute = *cloud.attribute(id);
  const std::optional<ScalarType> type = scalar_type(attribute.data_type());
  if (!type) return fail(ErrorKind::kInvalidInput, "Draco attribute of an unknown type");
  for (size_t component = 0; component < static_cast<size_t>(attribute.num_components()); ++component) {
    columns.push_back({component_name(cloud, id, component), *type, false});
    const bool whole = with_type(*type, [&](auto zero) {
      auto values = component_values<decltype(zero)>(cloud, attribute, component);
      if (values) add_column(table, std::move(*values));
      return values.has_value();
    });
    if (!whole) return fail(ErrorKind::kInvalidInput, "Draco point without a value of its attributes");
  }
  return {};
}

Result<std::unique_ptr<draco::PointCloud>> decode(std::span<const std::byte> bytes) {
  if (!draco_claims_are_plausible(bytes)) {
    return fail(ErrorKind::kInvalidInput, "Draco data is damaged: it claims more points than so many bytes can hold");
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // A mesh is a point cloud with faces, so it can be decoded as a point cloud.
  auto cloud = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  if (cloud.ok()) return std::move(cloud).value();
  return fail(ErrorKind::kInvalidInput,
              "Draco data cannot be decoded: " + printable(cloud.status().error_msg_string()));
}

/// The geometry type follows "DRACO" and two version bytes.
bool is_mesh(std::span<const std::byte> bytes) {
  constexpr size_t kGeometryType = 7;
  return bytes.size() > kGeometryType && bytes[kGeometryType] == std::byte{1};
}

}  // namespace

Result<std::unique_ptr<RowSource>> draco_rows(std::span<const std::byte> bytes, const DecodingLimit& limit) try {
  // Draco's copy of the points exists until the table is complete, hence the factor of 2.
  if (Status status = limit.check(2 * draco_decoded_bytes(bytes)); !status) return fail(status);
  const Result<std::unique_ptr<draco::PointCloud>> cloud = decode(bytes);
  if (!cloud) return fail(cloud);
  std::vector<ColumnInfo> columns;
  PointTable table;
  table.rows = (*cloud)->num_points();
  for (int id = 0; id < (*cloud)->num_attributes(); ++id) {
    if (Status status = add_attribute(**cloud, id, columns, table); !status) return fail(status);
  }
  RowTraits traits;
  traits.may_be_graphics = is_mesh(bytes);  // meshes come from graphics, y-up; points come from scanners, z-up
  return std::make_unique<SlicedRows>(traits, std::move(columns), std::move(table));
} catch (const std::exception&) {
  // The library allocates what a damaged header asks for, and throws if the allocation fails.
  return fail(ErrorKind::kInvalidInput, "Draco data is damaged");
}

}  // namespace surfcast::scan
