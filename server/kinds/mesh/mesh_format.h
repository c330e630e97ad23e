#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

namespace surfcast::mesh {

enum class MeshFormat { kObj, kGltf, kGlb, kPly, kStl };

/// Whether faces of PLY files become surfels, or their vertices as those of a scan.
enum class FacePolicy { kAuto, kUse, kIgnore };

/// The format of a mesh, by its content; by its extension where the content is text like any other. None if the file
/// is no mesh. PLY files with faces are meshes if the faces or the vertices have colours or texture coordinates, unless
/// `faces` decides otherwise: without them, vertices say as much as faces.
[[nodiscard]] std::optional<MeshFormat> mesh_format_of(std::span<const std::byte> bytes,
                                                       const std::filesystem::path& path,
                                                       FacePolicy faces = FacePolicy::kAuto);

}  // namespace surfcast::mesh
