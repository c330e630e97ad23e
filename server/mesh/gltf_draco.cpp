#include "mesh/gltf_draco.h"

#include <exception>
#include <memory>
#include <utility>

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include "scan/draco_claims.h"
#include "scan/text_tokens.h"

namespace surfcast::mesh {
namespace {

/// The values of an attribute for each point; integers are normalised if the attribute says so.
Result<AccessorValues> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute) {
  constexpr int8_t kMostComponents = 4;
  const auto components = static_cast<size_t>(attribute.num_components());
  if (components == 0 || attribute.num_components() > kMostComponents) {
    return fail(ErrorKind::kInvalidInput, "Draco attribute of an unknown type");
  }
  AccessorValues values{components, std::vector<double>(mesh.num_points() * components)};
  for (uint32_t i = 0; i < mesh.num_points(); ++i) {
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

}  // namespace

Result<PrimitiveValues> decode_draco(Bytes bytes, const std::map<std::string, uint32_t>& ids) try {
  if (!scan::draco_claims_are_plausible(bytes)) {
    return fail(ErrorKind::kInvalidInput, "Draco data is damaged: it claims more points than so many bytes can hold");
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    return fail(ErrorKind::kInvalidInput,
                "Draco data cannot be decoded: " + scan::printable(decoded.status().error_msg_string()));
  }
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  PrimitiveValues made;
  for (const auto& [name, id] : ids) {
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(id);
    if (attribute == nullptr) return fail(ErrorKind::kInvalidInput, "Draco data without the attribute " + name);
    Result<AccessorValues> values = values_of(*mesh, *attribute);
    if (!values) return fail(std::move(values.error()));
    made.attributes.emplace(name, std::move(*values));
  }
  made.indices = indices_of(*mesh);
  return made;
} catch (const std::exception&) {
  // The library allocates what a damaged header asks for, and throws if the allocation fails.
  return fail(ErrorKind::kInvalidInput, "Draco data is damaged");
}

}  // namespace surfcast::mesh
