#include "cmd/mesh_flags.h"

#include <spdlog/fmt/fmt.h>

#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

mesh::FacePolicy face_policy(const std::string& name) {
  if (name == "use") return mesh::FacePolicy::kUse;
  return name == "ignore" ? mesh::FacePolicy::kIgnore : mesh::FacePolicy::kAuto;
}

std::string name_of_faces(mesh::FacePolicy policy) {
  if (policy == mesh::FacePolicy::kUse) return "use";
  return policy == mesh::FacePolicy::kIgnore ? "ignore" : "auto";
}

}  // namespace

void add_mesh_flags(CLI::App& command, builder::MeshOptions& options) {
  command
      .add_option("--mesh-spacing", options.spacing,
                  "Distance of the surfels of a mesh, in its units (default: one surfel a texel, and 1/1500 of the "
                  "diagonal where there is no texture)")
      ->envname(protocol::environment_name("mesh-spacing"))
      ->check(CLI::PositiveNumber);
  command
      .add_option("--mesh-surfels", options.most_surfels,
                  "Most surfels of a mesh: distances are doubled until there are no more (default: 200000000)")
      ->envname(protocol::environment_name("mesh-surfels"))
      ->check(CLI::PositiveNumber);
  command
      .add_option_function<std::string>(
          "--faces", [&options](const std::string& name) { options.faces = face_policy(name); },
          "Faces of PLY files: use them (surfels of a mesh), ignore them (its vertices are a scan), or auto: use them "
          "where there are colours or texture coordinates (default auto)")
      ->envname(protocol::environment_name("faces"))
      ->check(CLI::IsMember({"auto", "use", "ignore"}));
}

std::vector<std::string> arguments_of(const builder::MeshOptions& options) {
  const builder::MeshOptions usual;
  std::vector<std::string> arguments;
  if (options.spacing) arguments.insert(arguments.end(), {"--mesh-spacing", fmt::format("{}", *options.spacing)});
  if (options.most_surfels != usual.most_surfels) {
    arguments.insert(arguments.end(), {"--mesh-surfels", std::to_string(options.most_surfels)});
  }
  if (options.faces != usual.faces) arguments.insert(arguments.end(), {"--faces", name_of_faces(options.faces)});
  return arguments;
}

}  // namespace surfcast::cmd
