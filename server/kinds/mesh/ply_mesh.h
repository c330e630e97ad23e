#pragma once

#include <cstddef>
#include <span>

#include "mesh/mesh_format.h"

namespace surfcast::mesh {

/// True if the header states faces that are to be used.
[[nodiscard]] bool is_ply_mesh(std::span<const std::byte> bytes, FacePolicy faces);

/// True if the header states faces, used or not.
[[nodiscard]] bool has_ply_faces(std::span<const std::byte> bytes);

}  // namespace surfcast::mesh
