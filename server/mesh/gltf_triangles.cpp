#include "mesh/gltf_triangles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <map>
#include <string>
#include <utility>

#include "base/invalid_input.h"
#include "mesh/gltf_draco.h"

namespace surfcast::mesh {
namespace {

template <typename Vector>
std::vector<Vector> vectors_of(const AccessorValues& values) {
  std::vector<Vector> vectors(values.count(), Vector(0));
  const auto axes = std::min(values.components, static_cast<size_t>(Vector::length()));
  for (size_t i = 0; i < vectors.size(); ++i) {
    for (size_t k = 0; k < axes; ++k) {
      vectors[i][static_cast<int>(k)] =
          static_cast<typename Vector::value_type>(values.values[i * values.components + k]);
    }
  }
  return vectors;
}

/// Linear light, with alpha 1 where there is none.
std::vector<glm::vec4> colors_of(const AccessorValues& values) {
  std::vector<glm::vec4> colors = vectors_of<glm::vec4>(values);
  for (glm::vec4& color : colors) {
    if (values.components < 4) color.a = 1;
    color = glm::clamp(color, 0.0F, 1.0F);
  }
  return colors;
}

/// Corners of triangles from those of strips and fans (glTF 2.0, section 3.7.2.1).
std::vector<std::array<uint32_t, 3>> corners_of(const std::vector<uint32_t>& corners, uint64_t mode) {
  std::vector<std::array<uint32_t, 3>> made;
  if (mode == 4) {
    for (size_t i = 0; i + 2 < corners.size(); i += 3) made.push_back({corners[i], corners[i + 1], corners[i + 2]});
    return made;
  }
  for (size_t i = 0; i + 2 < corners.size(); ++i) {
    const bool fan = mode == 6;
    const size_t odd = i % 2;
    made.push_back(fan ? std::array{corners[0], corners[i + 1], corners[i + 2]}
                       : std::array{corners[i], corners[i + 1 + odd], corners[i + 2 - odd]});
  }
  return made;
}

/// Reads the attributes and indices of a primitive.
class ValueReader {
 public:
  ValueReader(const Json& json, GltfBuffers& buffers) : json_(json), buffers_(buffers) {}
  Result<PrimitiveValues> read(const Json& stated, const std::vector<std::string>& wanted);

 private:
  Status add_compressed(const Json& compressed, const Json& attributes, const std::vector<std::string>& wanted,
                        PrimitiveValues& made);
  Status add_indices(const Json& stated, PrimitiveValues& made);
  Status add_plain(const Json& attributes, const std::vector<std::string>& wanted, PrimitiveValues& made);

  const Json& json_;
  GltfBuffers& buffers_;
};

Status ValueReader::add_compressed(const Json& compressed, const Json& attributes,
                                   const std::vector<std::string>& wanted, PrimitiveValues& made) {
  const Result<Bytes> bytes = buffers_.view(json_, integer_of(compressed, "bufferView").value_or(UINT64_MAX));
  if (!bytes) return fail(bytes.error());
  std::map<std::string, uint32_t> ids;
  for (const std::string& name : wanted) {
    const std::optional<uint64_t> id = integer_of(member(compressed, "attributes"), name.c_str());
    if (id && *id < kNone) ids.emplace(name, static_cast<uint32_t>(*id));
  }
  Result<PrimitiveValues> decoded = decode_draco(*bytes, ids);
  if (!decoded) return fail(std::move(decoded.error()));
  for (auto& [name, values] : decoded->attributes) {
    if (Status status = buffers_.set_aside(values.values.size() * sizeof(double)); !status) return status;
    const uint64_t number = integer_of(attributes, name.c_str()).value_or(UINT64_MAX);
    const Json& accessor = element(member(json_, "accessors"), number);
    const std::map<uint64_t, double> brightest{{5120, 127}, {5121, 255}, {5122, 32767}, {5123, 65535}};
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
    if (!values) return fail(std::move(values.error()));
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
  if (!values) return fail(values.error());
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
  Status status = compressed.is_object() ? add_compressed(compressed, attributes, wanted, made) : Status();
  if (status) status = add_plain(attributes, wanted, made);
  if (status && made.attributes["POSITION"].components != 3) status = invalid_input("glTF primitive without positions");
  if (status && !compressed.is_object()) status = add_indices(stated, made);
  if (!status) return fail(std::move(status.error()));
  return made;
}

/// `uvs`: name of the texture coordinates. Attributes of another length than the positions are left out.
std::shared_ptr<const Vertices> vertices_of(PrimitiveValues& values, const UvRule& rule, const std::string& uvs) {
  auto vertices = std::make_shared<Vertices>();
  vertices->positions = vectors_of<glm::dvec3>(values.attributes["POSITION"]);
  const size_t count = vertices->positions.size();
  const auto whole = [&](const std::string& name) { return count > 0 && values.attributes[name].count() == count; };
  if (whole("NORMAL")) vertices->normals = vectors_of<glm::vec3>(values.attributes["NORMAL"]);
  if (whole("COLOR_0")) vertices->colors = colors_of(values.attributes["COLOR_0"]);
  if (whole(uvs)) vertices->uvs = vectors_of<glm::dvec2>(values.attributes[uvs]);
  for (glm::dvec2& uv : vertices->uvs) uv = rule.apply(uv);
  return vertices;
}

Result<std::vector<Triangle>> triangles_of(const std::vector<uint32_t>& indices, uint64_t mode,
                                           const Vertices& vertices) {
  std::vector<Triangle> triangles;
  for (const std::array<uint32_t, 3>& corners : corners_of(indices, mode)) {
    Triangle& triangle = triangles.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      if (corners[k] >= vertices.positions.size()) {
        return invalid_input("glTF primitive with an index beyond its vertices");
      }
      triangle[k] = {corners[k], vertices.normals.empty() ? kNone : corners[k],
                     vertices.uvs.empty() ? kNone : corners[k]};
    }
  }
  return triangles;
}

}  // namespace

Result<std::optional<GltfTriangles>> read_gltf_triangles(const Json& json, const Json& stated, const UvRule& uv,
                                                         GltfBuffers& buffers) {
  const uint64_t mode = integer_of(stated, "mode").value_or(4);
  if (mode < 4 || mode > 6) return std::optional<GltfTriangles>();
  const std::string uvs = "TEXCOORD_" + std::to_string(uv.set);
  ValueReader reader(json, buffers);
  Result<PrimitiveValues> values = reader.read(stated, {"POSITION", "NORMAL", "COLOR_0", uvs});
  if (!values) return fail(std::move(values.error()));
  const std::shared_ptr<const Vertices> vertices = vertices_of(*values, uv, uvs);
  Result<std::vector<Triangle>> triangles = triangles_of(values->indices, mode, *vertices);
  if (!triangles) return fail(std::move(triangles.error()));
  return std::optional(GltfTriangles{vertices, std::make_shared<const std::vector<Triangle>>(std::move(*triangles))});
}

}  // namespace surfcast::mesh
