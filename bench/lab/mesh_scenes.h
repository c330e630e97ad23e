#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace surfcast::lab {

/// Textured meshes with detail of every kind: noise of single texels, a zone plate, strokes, flat parts. The plane is
/// 2 x 2 with 512 x 512 texels. The cube is 2 x 2 x 2 and has six charts of 240 x 368 texels, with magenta between
/// them. The unit sphere has 512 x 512 texels twice around it, and a seam.
std::vector<std::string> mesh_scene_names();

/// Writes a scene as NAME.obj with its material and image. None if there is no scene of that name.
std::optional<std::filesystem::path> write_mesh_scene(const std::string& name, const std::filesystem::path& folder);

}  // namespace surfcast::lab
