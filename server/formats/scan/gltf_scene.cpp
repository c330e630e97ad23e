#include "scan/gltf_scene.h"

#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/invalid_input.h"
#include "scan/gltf_primitive.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

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

/// The nodes of a scene that are still to be visited, the next one last.
using OpenNodes = std::vector<std::pair<uint64_t, glm::dmat4>>;

void push(const Json& numbers, const glm::dmat4& to_world, OpenNodes& open) {
  for (auto number = numbers.rbegin(); number != numbers.rend(); ++number) {
    if (const std::optional<uint64_t> node = integer_of(*number)) open.emplace_back(*node, to_world);
  }
}

}  // namespace

Status check_gltf_extensions(const Json& json, std::span<const std::string_view> also) {
  constexpr std::array<std::string_view, 5> kRead{kDracoExtension, kMeshoptExtension, "KHR_mesh_quantization",
                                                  "EXT_mesh_features", "EXT_structural_metadata"};
  for (const Json& stated : member(json, "extensionsRequired")) {
    if (!stated.is_string()) continue;
    const auto name = stated.get<std::string>();
    const bool read = std::find(kRead.begin(), kRead.end(), name) != kRead.end() ||
                      std::find(also.begin(), also.end(), name) != also.end();
    if (read || name.starts_with("KHR_materials_") || name.starts_with("KHR_lights_")) continue;
    return fail(ErrorKind::kUnsupported, "needs the glTF extension " + printable(name) + ", which is not supported");
  }
  return {};
}

/// A node is shown once, with all nodes below it. Nodes in a circle would have no end.
Status visit_gltf_nodes(const Json& json,
                        const std::function<Status(const Json& node, const glm::dmat4& to_world)>& use) {
  const Json& nodes = member(json, "nodes");
  const Json& scene = element(member(json, "scenes"), integer_of(json, "scene").value_or(0));
  OpenNodes open;
  push(scene.is_object() ? member(scene, "nodes") : roots_of(nodes), glm::dmat4(1), open);
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
    if (Status status = use(node, to_world); !status) return status;
    push(member(node, "children"), to_world, open);
  }
  return {};
}

}  // namespace surfcast::scan
