#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <map>
#include <string>
#include <utility>

#include "base/invalid_input.h"
#include "geometry/finite.h"
#include "mesh/gltf_materials.h"
#include "mesh/gltf_triangles.h"
#include "mesh/model_files.h"
#include "mesh/readers.h"
#include "scan/gltf_buffers.h"
#include "scan/gltf_scene.h"

namespace surfcast::mesh {
namespace {

/// Extensions of textures that are read.
constexpr std::array<std::string_view, 2> kRead{"EXT_texture_webp", "KHR_texture_transform"};

/// A primitive, ready for any number of instances.
struct Primitive {
  GltfTriangles parts;
  size_t material = 0;
};

class GltfModel {
 public:
  GltfModel(const ModelFile& file, const scan::GltfParts& parts, scan::GltfBuffers buffers)
      : file_(file), json_(parts.json), buffers_(std::move(buffers)) {}

  Result<Mesh> read() {
    add_images();
    add_materials();
    const auto add = [this](const Json& node, const glm::dmat4& to_world) { return add_node(node, to_world); };
    if (Status status = scan::visit_gltf_nodes(json_, add); !status) return fail(status);
    mesh_.contents = buffers_.contents();
    for (std::shared_ptr<const void>& content : decoded_) mesh_.contents.push_back(std::move(content));
    return std::move(mesh_);
  }

 private:
  void add_images();
  ImageSource image_of(const Json& stated);
  void add_materials();
  void add_material(const Json& stated);
  Status add_node(const Json& node, const glm::dmat4& to_world);
  Result<const std::vector<Primitive>*> primitives_of(uint64_t mesh);
  Status add_primitive(const Json& stated, std::vector<Primitive>& made);
  void note_once(const std::string& note) {
    if (std::find(mesh_.notes.begin(), mesh_.notes.end(), note) == mesh_.notes.end()) mesh_.notes.push_back(note);
  }

  const ModelFile& file_;
  const Json& json_;
  scan::GltfBuffers buffers_;
  Mesh mesh_;
  std::vector<UvRule> uv_rules_;  ///< of each material
  std::vector<std::shared_ptr<const void>> decoded_;
  std::map<uint64_t, std::vector<Primitive>> primitives_;  ///< of each mesh that was read
};

ImageSource GltfModel::image_of(const Json& stated) {
  const std::string uri = text_of(stated, "uri");
  ImageSource image{"image " + std::to_string(mesh_.images.size()), {}, {}, {}};
  if (const std::optional<uint64_t> view = integer_of(stated, "bufferView")) {
    const Result<std::span<const std::byte>> bytes = buffers_.view(json_, *view);
    if (bytes) {
      image.bytes = *bytes;
    } else {
      image.unavailable = "is not in the file";
    }
    return image;
  }
  if (std::optional<std::vector<std::byte>> decoded = scan::decode_data_uri(uri)) {
    const auto kept = std::make_shared<const std::vector<std::byte>>(std::move(*decoded));
    decoded_.push_back(kept);
    image.bytes = *kept;
    return image;
  }
  return named_image(file_.path, uri);
}

void GltfModel::add_images() {
  for (const Json& image : member(json_, "images")) mesh_.images.push_back(image_of(image));
}

void GltfModel::add_material(const Json& stated) {
  GltfMaterial made = read_gltf_material(json_, stated, mesh_.images.size());
  if (made.other_maps) note_once("of the textures those of base colour alone are used");
  mesh_.materials.push_back(std::move(made.material));
  uv_rules_.push_back(made.uv);
}

void GltfModel::add_materials() {
  for (const Json& material : member(json_, "materials")) add_material(material);
  add_material(Json::object());  // of primitives without one
}

Status GltfModel::add_node(const Json& node, const glm::dmat4& to_world) {
  const std::optional<uint64_t> number = integer_of(node, "mesh");
  if (!number) return {};
  if (integer_of(node, "skin")) note_once("skins are not used: the model is in its rest pose");
  const Result<const std::vector<Primitive>*> primitives = primitives_of(*number);
  if (!primitives) return fail(primitives);
  for (const Primitive& primitive : **primitives) {
    const auto inside = [&](const glm::dvec3& p) { return geometry::finite(glm::dvec3(to_world * glm::dvec4(p, 1))); };
    const std::vector<glm::dvec3>& positions = primitive.parts.vertices->positions;
    if (!std::all_of(positions.begin(), positions.end(), inside)) {
      return invalid_input("glTF mesh with a position that is not finite");
    }
    mesh_.patches.push_back({primitive.parts.vertices, primitive.parts.triangles, primitive.material, to_world});
  }
  return {};
}

Result<const std::vector<Primitive>*> GltfModel::primitives_of(uint64_t mesh) {
  if (const auto known = primitives_.find(mesh); known != primitives_.end()) return &known->second;
  std::vector<Primitive> made;
  for (const Json& stated : member(element(member(json_, "meshes"), mesh), "primitives")) {
    if (Status status = add_primitive(stated, made); !status) return fail(status);
  }
  return &primitives_.emplace(mesh, std::move(made)).first->second;
}

Status GltfModel::add_primitive(const Json& stated, std::vector<Primitive>& made) {
  const uint64_t fallback = mesh_.materials.size() - 1;
  const auto material = static_cast<size_t>(std::min(integer_of(stated, "material").value_or(fallback), fallback));
  Result<std::optional<GltfTriangles>> read = read_gltf_triangles(json_, stated, uv_rules_[material], buffers_);
  if (!read) return fail(read);
  if (*read) {
    made.push_back({std::move(**read), material});
  } else {
    note_once("points and lines are left out");
  }
  return {};
}

}  // namespace

Result<Mesh> read_gltf(const ModelFile& file, const scan::DecodingLimit& limit) {
  const Result<scan::GltfParts> parts = scan::split_gltf(file.bytes());
  if (!parts) return fail(parts);
  if (Status status = scan::check_gltf_extensions(parts->json, kRead); !status) return fail(status);
  Result<scan::GltfBuffers> buffers = scan::GltfBuffers::open(file.path, *parts, limit);
  if (!buffers) return fail(buffers);
  return GltfModel(file, *parts, std::move(*buffers)).read();
}

std::vector<std::filesystem::path> files_of_gltf(const ModelFile& file) {
  std::vector<std::filesystem::path> files;
  const Result<scan::GltfParts> parts = scan::split_gltf(file.bytes());
  if (!parts) return files;
  for (const Json& buffer : member(parts->json, "buffers")) {
    const std::string uri = text_of(buffer, "uri");
    if (uri.empty() || uri.starts_with("data:")) continue;
    if (std::optional<std::filesystem::path> path = named_file(file.path, uri)) files.push_back(std::move(*path));
  }
  return files;
}

}  // namespace surfcast::mesh
