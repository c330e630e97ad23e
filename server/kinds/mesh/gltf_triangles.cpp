#include "mesh/gltf_triangles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <map>
#include <string>
#include <utility>

#include "base/invalid_input.h"
#include "scan/gltf_primitive.h"

namespace surfcast::mesh {
namespace {

using scan::AccessorValues;
using scan::PrimitiveValues;

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
                                                         scan::GltfBuffers& buffers) {
  const uint64_t mode = scan::gltf_mode(stated);
  if (mode < 4 || mode > 6) return std::optional<GltfTriangles>();
  const std::string uvs = "TEXCOORD_" + std::to_string(uv.set);
  Result<PrimitiveValues> values =
      scan::read_gltf_primitive(json, stated, {"POSITION", "NORMAL", "COLOR_0", uvs}, buffers);
  if (!values) return fail(values);
  const std::shared_ptr<const Vertices> vertices = vertices_of(*values, uv, uvs);
  Result<std::vector<Triangle>> triangles = triangles_of(values->indices, mode, *vertices);
  if (!triangles) return fail(triangles);
  return std::optional(GltfTriangles{vertices, std::make_shared<const std::vector<Triangle>>(std::move(*triangles))});
}

}  // namespace surfcast::mesh
