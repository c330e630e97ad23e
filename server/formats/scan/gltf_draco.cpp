#include "scan/gltf_draco.h"

#include <exception>
#include <memory>
#include <numeric>
#include <utility>

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include "scan/draco_claims.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

/// The values of an attribute for each point; integers are normalised if the attribute says so.
Result<AccessorValues> values_of(const draco::PointCloud& points, const draco::PointAttribute& attribute) {
  constexpr int8_t kMaxComponents = 4;
  const auto components = static_cast<size_t>(attribute.num_components());
  if (components == 0 || attribute.num_components() > kMaxComponents) {
    return fail(ErrorKind::kInvalidInput, "Draco attribute of an unknown type");
  }
  AccessorValues values{components, std::vector<double>(points.num_points() * components)};
  for (uint32_t i = 0; i < points.num_points(); ++i) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(i));
    if (index.value() >= attribute.size() ||
        !attribute.ConvertValue(index, attribute.num_components(), values.values.data() + i * components)) {
      return fail(ErrorKind::kInvalidInput, "Draco point without a value of its attributes");
    }
  }
  return values;
}

std::vector<uint32_t> indices_of(const draco::Mesh& mesh) {
  std::vector<uint32_t> indices;
  for (draco::FaceIndex i(0); i < mesh.num_faces(); ++i) {
    for (const draco::PointIndex& corner : mesh.face(i)) indices.push_back(corner.value());
  }
  return indices;
}

tl::unexpected<Error> cannot_decode(const draco::Status& status) {
  return fail(ErrorKind::kInvalidInput, "Draco data cannot be decoded: " + printable(status.error_msg_string()));
}

Result<PrimitiveValues> attributes_of(const draco::PointCloud& points, const std::map<std::string, uint32_t>& ids) {
  PrimitiveValues made;
  for (const auto& [name, id] : ids) {
    const draco::PointAttribute* attribute = points.GetAttributeByUniqueId(id);
    if (attribute == nullptr) return fail(ErrorKind::kInvalidInput, "Draco data without the attribute " + name);
    Result<AccessorValues> values = values_of(points, *attribute);
    if (!values) return fail(values);
    made.attributes.emplace(name, std::move(*values));
  }
  return made;
}

Result<PrimitiveValues> decode_mesh(draco::DecoderBuffer& buffer, const std::map<std::string, uint32_t>& ids) {
  const auto mesh = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) return cannot_decode(mesh.status());
  Result<PrimitiveValues> made = attributes_of(*mesh.value(), ids);
  if (made) made->indices = indices_of(*mesh.value());
  return made;
}

/// The points of a mesh too, which is a point cloud with faces.
Result<PrimitiveValues> decode_points(draco::DecoderBuffer& buffer, const std::map<std::string, uint32_t>& ids) {
  const auto points = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  if (!points.ok()) return cannot_decode(points.status());
  Result<PrimitiveValues> made = attributes_of(*points.value(), ids);
  if (!made) return made;
  made->indices.resize(points.value()->num_points());
  std::iota(made->indices.begin(), made->indices.end(), 0);
  return made;
}

}  // namespace

Result<PrimitiveValues> decode_draco(std::span<const std::byte> bytes, const std::map<std::string, uint32_t>& ids,
                                     DracoGeometry geometry) try {
  if (!draco_claims_are_plausible(bytes)) {
    return fail(ErrorKind::kInvalidInput, "Draco data is damaged: it claims more points than so many bytes can hold");
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return geometry == DracoGeometry::kFaces ? decode_mesh(buffer, ids) : decode_points(buffer, ids);
} catch (const std::exception&) {
  // The library allocates what a damaged header asks for, and throws if the allocation fails.
  return fail(ErrorKind::kInvalidInput, "Draco data is damaged");
}

}  // namespace surfcast::scan
