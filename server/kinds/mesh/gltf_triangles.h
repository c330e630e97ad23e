#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "mesh/gltf_materials.h"
#include "mesh/json_access.h"
#include "mesh/mesh.h"
#include "scan/gltf_buffers.h"

namespace surfcast::mesh {

/// The triangles of a primitive of a glTF file, in the frame of its mesh.
struct GltfTriangles {
  std::shared_ptr<const Vertices> vertices;
  std::shared_ptr<const std::vector<Triangle>> triangles;
};

/// `json`: the file, `uv`: how the texture's coordinates are found. None if the primitive is of points or lines.
Result<std::optional<GltfTriangles>> read_gltf_triangles(const Json& json, const Json& stated, const UvRule& uv,
                                                         scan::GltfBuffers& buffers);

}  // namespace surfcast::mesh
