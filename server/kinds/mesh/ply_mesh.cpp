#include "mesh/ply_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "mesh/model_files.h"
#include "mesh/readers.h"
#include "scan/ply_header.h"
#include "scan/text_tokens.h"
#include "surfel/srgb.h"

namespace surfcast::mesh {
namespace {

using scan::PlyElement;
using scan::PlyEncoding;
using scan::PlyHeader;
using scan::PlyProperty;

const PlyElement* find_element(const PlyHeader& header, std::string_view name) {
  const auto at = std::find_if(header.elements.begin(), header.elements.end(),
                               [name](const PlyElement& element) { return element.name == name; });
  return at == header.elements.end() ? nullptr : &*at;
}

/// The first property with one of the names.
std::optional<size_t> find_property(const PlyElement& element, std::initializer_list<std::string_view> names) {
  for (size_t i = 0; i < element.properties.size(); ++i) {
    if (std::find(names.begin(), names.end(), element.properties[i].name) != names.end()) return i;
  }
  return std::nullopt;
}

std::optional<size_t> find_corners(const PlyElement& face) {
  return find_property(face, {"vertex_indices", "vertex_index"});
}

std::optional<size_t> find_u(const PlyElement& vertex) {
  return find_property(vertex, {"s", "u", "texture_u", "texture_s"});
}

/// Reads the numbers of a file one by one.
class Numbers {
 public:
  Numbers(std::span<const std::byte> data, PlyEncoding encoding)
      : rest_(data),
        tokens_(scan::as_text(data)),
        text_(encoding == PlyEncoding::kAscii),
        swapped_((encoding == PlyEncoding::kBinaryBigEndian) != (std::endian::native == std::endian::big)) {}

  std::optional<double> next(scan::ScalarType type) {
    if (text_) return scan::parse_number<double>(tokens_.next());
    if (rest_.size() < size_of(type)) return std::nullopt;
    const double number = scan::with_type(
        type, [&](auto zero) { return static_cast<double>(scan::load<decltype(zero)>(rest_.data(), swapped_)); });
    rest_ = rest_.subspan(size_of(type));
    return number;
  }

  /// Values that may still come, so that the file bounds what is set aside.
  [[nodiscard]] size_t at_most() const { return text_ ? tokens_.rest().size() : rest_.size(); }

 private:
  std::span<const std::byte> rest_;
  scan::Tokens tokens_;
  bool text_;
  bool swapped_;
};

/// The values of each property of a row: one, or those of a list.
using Row = std::vector<std::vector<double>>;

bool read_property(const PlyProperty& property, Numbers& numbers, std::vector<double>& values) {
  values.clear();
  double count = 1;
  if (property.list_count) {
    const std::optional<double> stated = numbers.next(*property.list_count);
    if (!stated || *stated < 0 || *stated > static_cast<double>(numbers.at_most())) return false;
    count = *stated;
  }
  for (size_t i = 0; static_cast<double>(i) < count; ++i) {
    const std::optional<double> number = numbers.next(property.type);
    if (!number) return false;
    values.push_back(*number);
  }
  return true;
}

Status walk(const PlyElement& element, Numbers& numbers, const std::function<Status(const Row&)>& use) {
  if (element.properties.empty()) return {};
  Row row(element.properties.size());
  for (uint64_t i = 0; i < element.count; ++i) {
    for (size_t k = 0; k < row.size(); ++k) {
      if (read_property(element.properties[k], numbers, row[k])) continue;
      return fail(ErrorKind::kInvalidInput, "truncated or damaged: the file ends within its " +
                                                std::to_string(element.count) + " " + scan::printable(element.name) +
                                                " elements");
    }
    if (Status status = use(row); !status) return status;
  }
  return {};
}

/// Where a row has what a vertex may have.
struct VertexColumns {
  std::array<std::optional<size_t>, 3> position;
  std::array<std::optional<size_t>, 3> normal;
  std::array<std::optional<size_t>, 4> color;
  std::array<std::optional<size_t>, 2> uv;
  double brightest = 255;  ///< of colours

  explicit VertexColumns(const PlyElement& vertex) {
    position = {find_property(vertex, {"x"}), find_property(vertex, {"y"}), find_property(vertex, {"z"})};
    normal = {find_property(vertex, {"nx"}), find_property(vertex, {"ny"}), find_property(vertex, {"nz"})};
    color = {find_property(vertex, {"red", "r", "diffuse_red"}), find_property(vertex, {"green", "g", "diffuse_green"}),
             find_property(vertex, {"blue", "b", "diffuse_blue"}), find_property(vertex, {"alpha", "a"})};
    uv = {find_u(vertex), find_property(vertex, {"t", "v", "texture_v", "texture_t"})};
    if (!color[0]) return;
    const scan::ScalarType type = vertex.properties[*color[0]].type;
    if (scan::is_floating(type)) brightest = 1;
    if (type == scan::ScalarType::kUint16) brightest = 65535;
  }

  [[nodiscard]] bool has_normals() const { return normal[0] && normal[1] && normal[2]; }
  [[nodiscard]] bool has_colors() const { return color[0] && color[1] && color[2]; }
  [[nodiscard]] bool has_uvs() const { return uv[0] && uv[1]; }
};

double value_at(const Row& row, const std::optional<size_t>& column) {
  return column && !row[*column].empty() ? row[*column][0] : 0.0;
}

template <typename Vector, size_t kCount>
Vector vector_at(const Row& row, const std::array<std::optional<size_t>, kCount>& columns) {
  Vector vector(0);
  for (int axis = 0; axis < Vector::length(); ++axis) {
    vector[axis] = static_cast<typename Vector::value_type>(value_at(row, columns[static_cast<size_t>(axis)]));
  }
  return vector;
}

/// sRGB to linear light; alpha stays what it is.
glm::vec4 color_at(const Row& row, const VertexColumns& columns) {
  const glm::dvec3 code = glm::clamp(vector_at<glm::dvec3>(row, columns.color) / columns.brightest, 0.0, 1.0);
  const double alpha = columns.color[3] ? value_at(row, columns.color[3]) / columns.brightest : 1.0;
  return {surfel::to_linear(glm::u16vec3(code * 65535.0 + 0.5), 16), static_cast<float>(std::clamp(alpha, 0.0, 1.0))};
}

glm::dvec2 upside_down(const glm::dvec2& uv) {
  return {uv.x, 1 - uv.y};  // v counts from the lower edge
}

/// Collects vertices and faces.
class MeshRows {
 public:
  MeshRows(const PlyElement& vertex, const PlyElement& face)
      : columns_(vertex),
        corners_(*find_corners(face)),
        texcoord_(find_property(face, {"texcoord"})),
        texnumber_(find_property(face, {"texnumber"})),
        vertices_(vertex.count) {
    if (texcoord_ && !face.properties[*texcoord_].list_count) texcoord_.reset();
  }

  Status add_vertex(const Row& row) {
    made_.positions.push_back(vector_at<glm::dvec3>(row, columns_.position));
    if (columns_.has_normals()) made_.normals.push_back(vector_at<glm::vec3>(row, columns_.normal));
    if (columns_.has_colors()) made_.colors.push_back(color_at(row, columns_));
    if (columns_.has_uvs() && !texcoord_) made_.uvs.push_back(upside_down(vector_at<glm::dvec2>(row, columns_.uv)));
    return {};
  }

  /// Polygons become fans, as their texture coordinates do.
  Status add_face(const Row& row) {
    const std::vector<double>& corners = row[corners_];
    std::vector<Corner> made;
    for (size_t k = 0; k < corners.size(); ++k) {
      const Result<Corner> corner = corner_of(row, k);
      if (!corner) return fail(corner);
      made.push_back(*corner);
    }
    std::vector<Triangle>& own = triangles_of(row);
    for (size_t k = 2; k < made.size(); ++k) own.push_back({made[0], made[k - 1], made[k]});
    return {};
  }

  /// Triangles by the number of their texture.
  std::vector<std::vector<Triangle>> triangles;

  Vertices take_vertices() { return std::move(made_); }
  [[nodiscard]] bool blends() const {
    return std::any_of(made_.colors.begin(), made_.colors.end(), [](const glm::vec4& color) { return color.a < 1; });
  }

 private:
  Result<Corner> corner_of(const Row& row, size_t k) {
    const double stated = row[corners_][k];
    if (!(stated >= 0 && stated < static_cast<double>(vertices_))) {
      return fail(ErrorKind::kInvalidInput, "PLY face with an index beyond its vertices");
    }
    const auto index = static_cast<uint32_t>(stated);
    Corner corner{index, columns_.has_normals() ? index : kNone, kNone};
    if (!texcoord_) {
      if (columns_.has_uvs()) corner.uv = index;
    } else if (const std::vector<double>& uvs = row[*texcoord_]; uvs.size() >= 2 * k + 2) {
      corner.uv = static_cast<uint32_t>(made_.uvs.size());
      made_.uvs.push_back(upside_down({uvs[2 * k], uvs[2 * k + 1]}));
    }
    return corner;
  }

  /// More textures than any model has; a number beyond it is none.
  static constexpr double kMaxTextures = 65536;

  std::vector<Triangle>& triangles_of(const Row& row) {
    const double stated = texnumber_ ? value_at(row, texnumber_) : 0;
    const size_t texture = stated >= 0 && stated < kMaxTextures ? static_cast<size_t>(stated) : 0;
    if (texture >= triangles.size()) triangles.resize(texture + 1);
    return triangles[texture];
  }

  VertexColumns columns_;
  size_t corners_;
  std::optional<size_t> texcoord_;
  std::optional<size_t> texnumber_;
  uint64_t vertices_;
  Vertices made_;
};

/// The names in lines "comment TextureFile NAME" of the header.
std::vector<std::string> texture_names(std::string_view header) {
  std::vector<std::string> names;
  while (!header.empty()) {
    const size_t end = std::min(header.find_first_of("\r\n"), header.size());
    scan::Tokens tokens(header.substr(0, end));
    header.remove_prefix(std::min(end + 1, header.size()));
    if (tokens.next() != "comment" || tokens.next() != "TextureFile") continue;
    const std::string_view rest = tokens.rest();
    const size_t first = std::min(rest.find_first_not_of(" \t"), rest.size());
    names.emplace_back(rest.substr(first));
  }
  return names;
}

Status check_positions(const Patch& patch) {
  for (const Triangle& triangle : *patch.triangles) {
    for (const Corner& corner : triangle) {
      const glm::dvec3& p = patch.vertices->positions[corner.position];
      if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
      return fail(ErrorKind::kInvalidInput, "PLY face with a corner that is not finite");
    }
  }
  return {};
}

Status read_elements(const PlyHeader& header, Numbers numbers, MeshRows& rows) {
  for (const PlyElement& element : header.elements) {
    Status status = walk(element, numbers, [&](const Row& row) {
      if (element.name == "vertex") return rows.add_vertex(row);
      return element.name == "face" ? rows.add_face(row) : Status();
    });
    if (!status) return status;
  }
  return {};
}

Material textured(size_t image, bool blends) {
  Material material;
  material.image = image;
  material.wrap.fill(Wrap::kClamp);
  if (blends) material.alpha = AlphaMode::kBlend;
  return material;
}

void add_patches(MeshRows& rows, const std::vector<std::string>& names, const std::filesystem::path& model,
                 Mesh& mesh) {
  const bool blends = rows.blends();
  for (const std::string& name : names) {
    mesh.materials.push_back(textured(mesh.images.size(), blends));
    mesh.images.push_back(named_image(model, name));
  }
  mesh.materials.emplace_back();
  if (blends) mesh.materials.back().alpha = AlphaMode::kBlend;
  const auto vertices = std::make_shared<const Vertices>(rows.take_vertices());
  for (size_t i = 0; i < rows.triangles.size(); ++i) {
    if (rows.triangles[i].empty()) continue;
    auto own = std::make_shared<const std::vector<Triangle>>(std::move(rows.triangles[i]));
    mesh.patches.push_back({vertices, std::move(own), std::min(i, names.size()), glm::dmat4(1)});
  }
}

}  // namespace

bool has_ply_faces(std::span<const std::byte> bytes) {
  const Result<PlyHeader> header = scan::parse_ply_header(bytes);
  if (!header) return false;
  const PlyElement* face = find_element(*header, "face");
  return face != nullptr && face->count > 0 && find_corners(*face) && find_element(*header, "vertex") != nullptr;
}

bool is_ply_mesh(std::span<const std::byte> bytes, FacePolicy faces) {
  if (faces == FacePolicy::kIgnore || !has_ply_faces(bytes)) return false;
  if (faces == FacePolicy::kUse) return true;
  const Result<PlyHeader> header = scan::parse_ply_header(bytes);
  const PlyElement& vertex = *find_element(*header, "vertex");
  const bool colors = find_property(vertex, {"red", "r", "diffuse_red"}).has_value();
  return colors || find_u(vertex) || find_property(*find_element(*header, "face"), {"texcoord"});
}

Result<Mesh> read_ply_mesh(const ModelFile& file, const scan::DecodingLimit& limit) {
  const Result<PlyHeader> header = scan::parse_ply_header(file.bytes());
  if (!header) return fail(header);
  const PlyElement* vertex = find_element(*header, "vertex");
  const PlyElement* face = find_element(*header, "face");
  if (vertex == nullptr || face == nullptr || !find_corners(*face)) {
    return fail(ErrorKind::kInvalidInput, "PLY file without faces");
  }
  if (vertex->count > std::numeric_limits<uint32_t>::max() - 1) {
    return fail(ErrorKind::kLimit, "PLY mesh of more than 4294967294 vertices");
  }
  // A face of 5 bytes with one corner makes nothing; a corner of one byte makes a triangle of 36 bytes and growth.
  if (Status status = limit.check(file.bytes().size() * 80); !status) return fail(status);
  MeshRows rows(*vertex, *face);
  const Numbers numbers(file.bytes().subspan(header->data_offset), header->encoding);
  if (Status status = read_elements(*header, numbers, rows); !status) return fail(status);
  Mesh mesh;
  add_patches(rows, texture_names(scan::as_text(file.bytes().first(header->data_offset))), file.path, mesh);
  for (const Patch& patch : mesh.patches) {
    if (Status status = check_positions(patch); !status) return fail(status);
  }
  return mesh;
}

}  // namespace surfcast::mesh
