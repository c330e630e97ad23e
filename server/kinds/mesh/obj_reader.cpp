#include <algorithm>
#include <cmath>
#include <fstream>
#include <istream>
#include <map>
#include <sstream>
#include <streambuf>
#include <string>
#include <utility>

#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include "geometry/finite.h"
#include "mesh/model_files.h"
#include "mesh/readers.h"
#include "scan/text_tokens.h"
#include "surfel/srgb.h"

namespace surfcast::mesh {
namespace {

/// Corners of a polygon beyond which it is refused: cutting it into triangles takes cubic time.
constexpr size_t kMaxCorners = 255;
/// Memory of the library's arrays and ours for each byte of a file, by measurement of files with short lines.
constexpr uint64_t kBytesPerByte = 16;

/// Bytes in memory as a stream.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(std::span<const std::byte> bytes) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): the stream is only read
    char* first = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    setg(first, first, first + bytes.size());
  }
};

/// The materials of libraries in the model's folder; what is missing becomes a note.
class FolderMaterials : public tinyobj::MaterialReader {
 public:
  FolderMaterials(std::filesystem::path model, std::vector<std::string>& notes)
      : model_(std::move(model)), notes_(notes) {}

  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* numbers, std::string* warn, std::string* err) override {
    const std::optional<std::filesystem::path> file = named_file(model_, name);
    std::ifstream stream;
    if (file) stream.open(*file);
    if (!stream.is_open()) {
      notes_.push_back("materials not found: " + scan::printable(name));
      return false;
    }
    tinyobj::LoadMtl(numbers, materials, &stream, warn, err);
    return true;
  }

 private:
  std::filesystem::path model_;
  std::vector<std::string>& notes_;
};

struct Loaded {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
};

/// Refuses polygons of very many corners before they are worked on.
Status check_polygons(std::string_view text) {
  while (!text.empty()) {
    const size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.size() < 2 * kMaxCorners) continue;
    scan::Tokens tokens(line);
    if (tokens.next() != "f") continue;
    size_t corners = 0;
    while (!tokens.next().empty()) ++corners;
    if (corners > kMaxCorners) {
      return fail(ErrorKind::kLimit, "OBJ face of more than " + std::to_string(kMaxCorners) + " corners");
    }
  }
  return {};
}

Result<Loaded> load(const ModelFile& file, std::vector<std::string>& notes) {
  MemoryBuffer buffer(file.bytes());
  std::istream stream(&buffer);
  FolderMaterials materials(file.path, notes);
  Loaded loaded;
  std::string warnings;
  std::string errors;
  const bool read = tinyobj::LoadObj(&loaded.attributes, &loaded.shapes, &loaded.materials, &warnings, &errors, &stream,
                                     &materials, true, false);
  if (read) return loaded;
  return fail(ErrorKind::kInvalidInput, "OBJ file cannot be read: " + scan::printable(errors));
}

template <typename Vector>
std::vector<Vector> vectors_of(const std::vector<double>& numbers) {
  constexpr auto kAxes = static_cast<size_t>(Vector::length());
  std::vector<Vector> vectors(numbers.size() / kAxes);
  for (size_t i = 0; i < vectors.size(); ++i) {
    for (size_t axis = 0; axis < kAxes; ++axis) {
      vectors[i][static_cast<int>(axis)] = static_cast<typename Vector::value_type>(numbers[kAxes * i + axis]);
    }
  }
  return vectors;
}

/// Vertex colours are sRGB from 0 to 1, or from 0 to 255 if one is larger than 1.
std::vector<glm::vec4> colors_of(const tinyobj::attrib_t& attributes) {
  if (attributes.colors.size() != attributes.vertices.size()) return {};
  const auto largest = std::max_element(attributes.colors.begin(), attributes.colors.end());
  if (largest == attributes.colors.end()) return {};
  const double scale = *largest > 1 ? 65535.0 / 255 : 65535.0;
  std::vector<glm::vec4> colors;
  for (const glm::dvec3& color : vectors_of<glm::dvec3>(attributes.colors)) {
    const glm::dvec3 code = glm::clamp(color * scale + 0.5, 0.0, 65535.0);
    colors.emplace_back(surfel::to_linear(glm::u16vec3(code), 16), 1.0F);
  }
  return colors;
}

Vertices vertices_of(const tinyobj::attrib_t& attributes) {
  Vertices vertices;
  vertices.positions = vectors_of<glm::dvec3>(attributes.vertices);
  vertices.normals = vectors_of<glm::vec3>(attributes.normals);
  vertices.uvs = vectors_of<glm::dvec2>(attributes.texcoords);
  for (glm::dvec2& uv : vertices.uvs) uv.y = 1 - uv.y;  // v counts from the lower edge
  vertices.colors = colors_of(attributes);
  return vertices;
}

glm::vec4 plain_color(const tinyobj::material_t& material) {
  const auto channel = [&](size_t i) { return static_cast<float>(std::clamp(material.diffuse[i], 0.0, 1.0)); };
  const glm::u16vec3 code(glm::vec3(channel(0), channel(1), channel(2)) * 65535.0F + 0.5F);
  return {surfel::to_linear(code, 16), static_cast<float>(std::clamp(material.dissolve, 0.0, 1.0))};
}

/// The images of a file, each once.
class NamedImages {
 public:
  NamedImages(std::filesystem::path model, std::vector<ImageSource>& images)
      : model_(std::move(model)), images_(images) {}

  size_t number_of(const std::string& name) {
    const auto [known, fresh] = numbers_.try_emplace(name, images_.size());
    if (fresh) images_.push_back(named_image(model_, name));
    return known->second;
  }

 private:
  std::filesystem::path model_;
  std::vector<ImageSource>& images_;
  std::map<std::string, size_t> numbers_;
};

/// `m`, the matte, is what the library states where a file does not say (`-imfchan`).
OpacityChannel channel_of(char stated) {
  switch (stated) {
    case 'r':
      return OpacityChannel::kRed;
    case 'g':
      return OpacityChannel::kGreen;
    case 'b':
      return OpacityChannel::kBlue;
    case 'l':
      return OpacityChannel::kLuminance;
    default:
      return OpacityChannel::kAuto;
  }
}

/// Kd counts only without a texture, beside which exporters leave any number. It is the colour that programs show, so
/// it is sRGB as the pixels of textures are. Opacities are the product of d and map_d, and of the alpha of map_Kd where
/// one of them is stated.
Material material_of(const tinyobj::material_t& stated, NamedImages& images) {
  Material material;
  material.name = stated.name;
  material.color = plain_color(stated);
  material.without_image = material.color;
  const bool colored = !stated.diffuse_texname.empty();
  const bool mapped = !stated.alpha_texname.empty();
  if (mapped || material.color.a < 1) material.alpha = AlphaMode::kBlend;
  if (mapped) {
    material.opacity = OpacityMap{images.number_of(stated.alpha_texname), channel_of(stated.alpha_texopt.imfchan)};
  }
  if (colored) {
    material.image = images.number_of(stated.diffuse_texname);
    material.color = glm::vec4(1, 1, 1, material.color.a);
  }
  const tinyobj::texture_option_t& options = colored ? stated.diffuse_texopt : stated.alpha_texopt;
  if (colored || mapped) material.wrap.fill(options.clamp ? Wrap::kClamp : Wrap::kRepeat);
  return material;
}

/// An index of the library, which is -1 where the file states none.
Result<uint32_t> index_of(int stated, size_t count) {
  if (stated == -1) return kNone;
  if (stated >= 0 && static_cast<size_t>(stated) < count) return static_cast<uint32_t>(stated);
  return fail(ErrorKind::kInvalidInput, "OBJ face with an index beyond its list");
}

Result<Corner> corner_of(const tinyobj::index_t& stated, const Vertices& vertices) {
  const Result<uint32_t> position = index_of(stated.vertex_index, vertices.positions.size());
  const Result<uint32_t> normal = index_of(stated.normal_index, vertices.normals.size());
  const Result<uint32_t> uv = index_of(stated.texcoord_index, vertices.uvs.size());
  for (const Result<uint32_t>* index : {&position, &normal, &uv}) {
    if (!*index) return fail(*index);
  }
  if (*position == kNone || !geometry::finite(vertices.positions[*position])) {
    return fail(ErrorKind::kInvalidInput, "OBJ face with a corner without a position");
  }
  return Corner{*position, *normal, *uv};
}

/// The triangles of each material; those without one come last.
Result<std::vector<std::vector<Triangle>>> triangles_of(const Loaded& loaded, const Vertices& vertices) {
  const size_t materials = loaded.materials.size();
  std::vector<std::vector<Triangle>> sorted(materials + 1);
  for (const tinyobj::shape_t& shape : loaded.shapes) {
    for (size_t face = 0; 3 * face + 2 < shape.mesh.indices.size(); ++face) {
      Triangle triangle;
      for (size_t k = 0; k < 3; ++k) {
        const Result<Corner> corner = corner_of(shape.mesh.indices[3 * face + k], vertices);
        if (!corner) return fail(corner);
        triangle[k] = *corner;
      }
      const int stated = face < shape.mesh.material_ids.size() ? shape.mesh.material_ids[face] : -1;
      const bool known = stated >= 0 && static_cast<size_t>(stated) < materials;
      sorted[known ? static_cast<size_t>(stated) : materials].push_back(triangle);
    }
  }
  return sorted;
}

void note_left_out(const std::vector<tinyobj::material_t>& materials, std::vector<std::string>& notes) {
  const bool any = std::any_of(materials.begin(), materials.end(), [](const tinyobj::material_t& m) {
    return !m.bump_texname.empty() || !m.normal_texname.empty() || !m.specular_texname.empty() ||
           !m.emissive_texname.empty() || !m.displacement_texname.empty();
  });
  if (any) notes.emplace_back("of the textures those of diffuse colour and opacity alone are used");
}

}  // namespace

Result<Mesh> read_obj(const ModelFile& file, const scan::DecodingLimit& limit) {
  if (Status status = limit.check(file.bytes().size() * kBytesPerByte); !status) return fail(status);
  if (Status status = check_polygons(scan::as_text(file.bytes())); !status) return fail(status);
  Mesh mesh;
  const Result<Loaded> loaded = load(file, mesh.notes);
  if (!loaded) return fail(loaded);
  const auto vertices = std::make_shared<const Vertices>(vertices_of(loaded->attributes));
  Result<std::vector<std::vector<Triangle>>> triangles = triangles_of(*loaded, *vertices);
  if (!triangles) return fail(triangles);
  NamedImages images(file.path, mesh.images);
  for (const tinyobj::material_t& material : loaded->materials) {
    mesh.materials.push_back(material_of(material, images));
  }
  mesh.materials.emplace_back();
  note_left_out(loaded->materials, mesh.notes);
  for (size_t i = 0; i < triangles->size(); ++i) {
    if ((*triangles)[i].empty()) continue;
    auto own = std::make_shared<const std::vector<Triangle>>(std::move((*triangles)[i]));
    mesh.patches.push_back({vertices, std::move(own), i, glm::dmat4(1)});
  }
  return mesh;
}

std::vector<std::filesystem::path> files_of_obj(const ModelFile& file) {
  std::vector<std::filesystem::path> files;
  std::string_view text = scan::as_text(file.bytes());
  while (!text.empty()) {
    const size_t end = std::min(text.find_first_of("\r\n"), text.size());
    scan::Tokens tokens(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (tokens.next() != "mtllib") continue;
    if (std::optional<std::filesystem::path> named = named_file(file.path, tokens.rest())) {
      files.push_back(std::move(*named));
    }
  }
  return files;
}

}  // namespace surfcast::mesh
