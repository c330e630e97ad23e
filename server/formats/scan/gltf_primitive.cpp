#include "scan/gltf_primitive.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/invalid_input.h"
#include "scan/draco_claims.h"

namespace surfcast::scan {
namespace {

/// Reads the attributes and indices of a primitive.
class ValueReader {
 public:
  ValueReader(const Json& json, GltfBuffers& buffers) : json_(json), buffers_(buffers) {}
  Result<PrimitiveValues> read(const Json& stated, const std::vector<std::string>& wanted);

 private:
  Status add_compressed(const Json& compressed, const Json& stated, const std::vector<std::string>& wanted,
                        PrimitiveValues& made);
  Status add_indices(const Json& stated, PrimitiveValues& made);
  Status add_plain(const Json& attributes, const std::vector<std::string>& wanted, PrimitiveValues& made);

  const Json& json_;
  GltfBuffers& buffers_;
};

Status ValueReader::add_compressed(const Json& compressed, const Json& stated, const std::vector<std::string>& wanted,
                                   PrimitiveValues& made) {
  const Result<std::span<const std::byte>> bytes =
      buffers_.view(json_, integer_of(compressed, "bufferView").value_or(UINT64_MAX));
  if (!bytes) return fail(bytes);
  if (Status status = buffers_.set_aside(draco_decoded_bytes(*bytes)); !status) return status;
  std::map<std::string, uint32_t> ids;
  for (const std::string& name : wanted) {
    const std::optional<uint64_t> id = integer_of(member(compressed, "attributes"), name.c_str());
    if (id && *id < UINT32_MAX) ids.emplace(name, static_cast<uint32_t>(*id));
  }
  const DracoGeometry geometry = gltf_mode(stated) == kGltfPoints ? DracoGeometry::kPoints : DracoGeometry::kFaces;
  Result<PrimitiveValues> decoded = decode_draco(*bytes, ids, geometry);
  if (!decoded) return fail(decoded);
  for (auto& [name, values] : decoded->attributes) {
    if (Status status = buffers_.set_aside(values.values.size() * sizeof(double)); !status) return status;
    const uint64_t number = integer_of(member(stated, "attributes"), name.c_str()).value_or(UINT64_MAX);
    const Json& accessor = element(member(json_, "accessors"), number);
    const std::map<uint64_t, double> brightest{
        {kGltfInt8, 127}, {kGltfUint8, 255}, {kGltfInt16, 32767}, {kGltfUint16, 65535}};
    const auto divisor = brightest.find(integer_of(accessor, "componentType").value_or(0));
    if (!flag_of(accessor, "normalized") || divisor == brightest.end()) continue;
    for (double& value : values.values) value = std::max(value / divisor->second, -1.0);
  }
  made = std::move(*decoded);
  return {};
}

Status ValueReader::add_plain(const Json& attributes, const std::vector<std::string>& wanted, PrimitiveValues& made) {
  for (const std::string& name : wanted) {
    const std::optional<uint64_t> accessor = integer_of(attributes, name.c_str());
    if (!accessor || made.attributes.contains(name)) continue;
    Result<AccessorValues> values = buffers_.values(json_, *accessor);
    if (!values) return fail(values);
    made.attributes.emplace(name, std::move(*values));
  }
  return {};
}

/// Without indices the vertices are the corners, in their order.
Status ValueReader::add_indices(const Json& stated, PrimitiveValues& made) {
  const size_t count = made.attributes["POSITION"].count();
  const std::optional<uint64_t> accessor = integer_of(stated, "indices");
  if (!accessor) {
    for (size_t i = 0; i < count; ++i) made.indices.push_back(static_cast<uint32_t>(i));
    return {};
  }
  const Result<AccessorValues> values = buffers_.values(json_, *accessor);
  if (!values) return fail(values);
  for (const double value : values->values) {
    if (!(value >= 0 && value < static_cast<double>(count))) {
      return invalid_input("glTF primitive with an index beyond its vertices");
    }
    made.indices.push_back(static_cast<uint32_t>(value));
  }
  return {};
}

Result<PrimitiveValues> ValueReader::read(const Json& stated, const std::vector<std::string>& wanted) {
  PrimitiveValues made;
  const Json& attributes = member(stated, "attributes");
  const Json& compressed = member(member(stated, "extensions"), kDracoExtension);
  Status status = compressed.is_object() ? add_compressed(compressed, stated, wanted, made) : Status();
  if (status) status = add_plain(attributes, wanted, made);
  if (status && made.attributes["POSITION"].components != 3) status = invalid_input("glTF primitive without positions");
  if (status && !compressed.is_object()) status = add_indices(stated, made);
  if (!status) return fail(status);
  return made;
}

}  // namespace

uint64_t gltf_mode(const Json& primitive) {
  constexpr uint64_t kTriangles = 4;
  return integer_of(primitive, "mode").value_or(kTriangles);
}

Result<PrimitiveValues> read_gltf_primitive(const Json& json, const Json& stated,
                                            const std::vector<std::string>& wanted, GltfBuffers& buffers) {
  return ValueReader(json, buffers).read(stated, wanted);
}

}  // namespace surfcast::scan
