#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>

#include "mesh/json_access.h"
#include "mesh/mesh.h"

namespace surfcast::mesh {

/// How the coordinates of a texture are found.
struct UvRule {
  uint64_t set = 0;
  glm::dvec2 offset{0};
  glm::dvec2 scale{1};
  double rotation = 0;

  /// Rotates counter-clockwise as seen with v down, after scaling (KHR_texture_transform).
  [[nodiscard]] glm::dvec2 apply(const glm::dvec2& uv) const;
};

/// A material of a glTF file.
struct GltfMaterial {
  Material material;
  UvRule uv;                ///< of its texture
  bool other_maps = false;  ///< it has textures that are not used
};

/// `json`: the file, `images`: the number of its images. What is damaged is left out.
GltfMaterial read_gltf_material(const Json& json, const Json& stated, size_t images);

}  // namespace surfcast::mesh
