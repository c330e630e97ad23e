#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <map>
#include <string>
#include <utility>

#include "base/invalid_input.h"
#include "mesh/gltf_buffers.h"
#include "mesh/gltf_materials.h"
#include "mesh/gltf_triangles.h"
#include "mesh/model_files.h"
#include "mesh/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::mesh {
namespace {

/// Extensions that change where surfaces are or what colours they have, and that are read. Others may only add to
/// materials and lights.
Status check_extensions(const Json& json) {
  constexpr std::array kRead{kDracoExtension, "EXT_texture_webp", "KHR_texture_transform", "KHR_mesh_quantization"};
  for (const Json& stated : member(json, "extensionsRequired")) {
    if (!stated.is_string()) continue;
    const auto name = stated.get<std::string>();
    const bool read = std::find(kRead.begin(), kRead.end(), name) != kRead.end();
    if (read || name.starts_with("KHR_materials_") || name.starts_with("KHR_lights_")) continue;
    return fail(ErrorKind::kUnsupported,
                "needs the glTF extension " + scan::printable(name) + ", which is not supported");
  }
  return {};
}

bool finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// A primitive, ready for any number of instances.
struct Primitive {
  GltfTriangles parts;
  size_t material = 0;
};

glm::dmat4 matrix_of(const Json& node) {
  if (const auto stated = numbers_of(node, "matrix", 16)) {
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = (*stated)[static_cast<size_t>(i)];
    return matrix;
  }
  const std::vector<double> t = numbers_of(node, "translation", 3).value_or(std::vector<double>(3, 0.0));
  const std::vector<double> s = numbers_of(node, "scale", 3).value_or(std::vector<double>(3, 1.0));
  const std::vector<double> q = numbers_of(node, "rotation", 4).value_or(std::vector<double>{0, 0, 0, 1});
  glm::dmat4 matrix = glm::mat4_cast(glm::dquat(q[3], q[0], q[1], q[2]));
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= s[static_cast<size_t>(axis)];
  matrix[3] = glm::dvec4(t[0], t[1], t[2], 1);
  return matrix;
}

/// The numbers of the nodes that are below no other one: a file without scenes shows them.
Json roots_of(const Json& nodes) {
  std::vector<bool> below(nodes.is_array() ? nodes.size() : 0);
  for (const Json& node : nodes) {
    for (const Json& child : member(node, "children")) {
      const std::optional<uint64_t> number = integer_of(child);
      if (number && *number < below.size()) below[static_cast<size_t>(*number)] = true;
    }
  }
  Json roots = Json::array();
  for (size_t i = 0; i < below.size(); ++i) {
    if (!below[i]) roots.push_back(i);
  }
  return roots;
}

class GltfModel {
 public:
  GltfModel(const ModelFile& file, const GltfParts& parts, GltfBuffers buffers)
      : file_(file), json_(parts.json), buffers_(std::move(buffers)) {}

  Result<Mesh> read() {
    add_images();
    add_materials();
    if (Status status = add_scene(); !status) return fail(std::move(status.error()));
    mesh_.contents = buffers_.contents();
    for (std::shared_ptr<const void>& content : decoded_) mesh_.contents.push_back(std::move(content));
    return std::move(mesh_);
  }

 private:
  void add_images();
  ImageSource image_of(const Json& stated);
  void add_materials();
  void add_material(const Json& stated);
  Status add_scene();
  Status add_node(const Json& node, const glm::dmat4& to_world);
  Result<const std::vector<Primitive>*> primitives_of(uint64_t mesh);
  Status add_primitive(const Json& stated, std::vector<Primitive>& made);
  void note_once(const std::string& note) {
    if (std::find(mesh_.notes.begin(), mesh_.notes.end(), note) == mesh_.notes.end()) mesh_.notes.push_back(note);
  }

  const ModelFile& file_;
  const Json& json_;
  GltfBuffers buffers_;
  Mesh mesh_;
  std::vector<UvRule> uv_rules_;  ///< of each material
  std::vector<std::shared_ptr<const void>> decoded_;
  std::map<uint64_t, std::vector<Primitive>> primitives_;  ///< of each mesh that was read
};

ImageSource GltfModel::image_of(const Json& stated) {
  const std::string uri = text_of(stated, "uri");
  ImageSource image{"image " + std::to_string(mesh_.images.size()), {}, {}, {}};
  if (const std::optional<uint64_t> view = integer_of(stated, "bufferView")) {
    const Result<Bytes> bytes = buffers_.view(json_, *view);
    if (bytes) {
      image.bytes = *bytes;
    } else {
      image.unavailable = "is not in the file";
    }
    return image;
  }
  if (std::optional<std::vector<std::byte>> decoded = decode_data_uri(uri)) {
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

/// A node is drawn once, with all nodes below it. Nodes in a circle would have no end.
Status GltfModel::add_scene() {
  const Json& nodes = member(json_, "nodes");
  const Json& scene = element(member(json_, "scenes"), integer_of(json_, "scene").value_or(0));
  std::vector<std::pair<uint64_t, glm::dmat4>> open;
  const auto push = [&open](const Json& numbers, const glm::dmat4& to_world) {
    for (const Json& number : numbers) {
      if (const std::optional<uint64_t> node = integer_of(number)) open.emplace_back(*node, to_world);
    }
  };
  push(scene.is_object() ? member(scene, "nodes") : roots_of(nodes), glm::dmat4(1));
  std::reverse(open.begin(), open.end());
  std::vector<bool> seen(nodes.is_array() ? nodes.size() : 0);
  while (!open.empty()) {
    const auto [number, above] = open.back();
    open.pop_back();
    if (number >= seen.size() || seen[static_cast<size_t>(number)]) {
      return invalid_input("glTF scene with a node that is not there, or more than once");
    }
    seen[static_cast<size_t>(number)] = true;
    const Json& node = element(nodes, number);
    const glm::dmat4 to_world = above * matrix_of(node);
    if (Status status = add_node(node, to_world); !status) return status;
    push(member(node, "children"), to_world);
  }
  return {};
}

Status GltfModel::add_node(const Json& node, const glm::dmat4& to_world) {
  const std::optional<uint64_t> number = integer_of(node, "mesh");
  if (!number) return {};
  if (integer_of(node, "skin")) note_once("skins are not used: the model is in its rest pose");
  const Result<const std::vector<Primitive>*> primitives = primitives_of(*number);
  if (!primitives) return fail(primitives.error());
  for (const Primitive& primitive : **primitives) {
    const auto inside = [&](const glm::dvec3& p) { return finite(glm::dvec3(to_world * glm::dvec4(p, 1))); };
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
    if (Status status = add_primitive(stated, made); !status) return fail(std::move(status.error()));
  }
  return &primitives_.emplace(mesh, std::move(made)).first->second;
}

Status GltfModel::add_primitive(const Json& stated, std::vector<Primitive>& made) {
  const uint64_t fallback = mesh_.materials.size() - 1;
  const auto material = static_cast<size_t>(std::min(integer_of(stated, "material").value_or(fallback), fallback));
  Result<std::optional<GltfTriangles>> read = read_gltf_triangles(json_, stated, uv_rules_[material], buffers_);
  if (!read) return fail(std::move(read.error()));
  if (*read) {
    made.push_back({std::move(**read), material});
  } else {
    note_once("points and lines are left out");
  }
  return {};
}

}  // namespace

Result<Mesh> read_gltf(const ModelFile& file, const scan::DecodingLimit& limit) {
  const Result<GltfParts> parts = split_gltf(file.bytes());
  if (!parts) return fail(parts.error());
  if (Status status = check_extensions(parts->json); !status) return fail(std::move(status.error()));
  Result<GltfBuffers> buffers = GltfBuffers::open(file, *parts, limit);
  if (!buffers) return fail(std::move(buffers.error()));
  return GltfModel(file, *parts, std::move(*buffers)).read();
}

std::vector<std::filesystem::path> files_of_gltf(const ModelFile& file) {
  std::vector<std::filesystem::path> files;
  const Result<GltfParts> parts = split_gltf(file.bytes());
  if (!parts) return files;
  for (const Json& buffer : member(parts->json, "buffers")) {
    const std::string uri = text_of(buffer, "uri");
    if (uri.empty() || uri.starts_with("data:")) continue;
    if (std::optional<std::filesystem::path> path = named_file(file.path, uri)) files.push_back(std::move(*path));
  }
  return files;
}

}  // namespace surfcast::mesh
