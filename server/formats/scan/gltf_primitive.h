#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/gltf_buffers.h"
#include "scan/gltf_draco.h"

namespace surfcast::scan {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

/// The mode of a primitive of points.
inline constexpr uint64_t kGltfPoints = 0;

/// What a primitive is of: points, lines, triangles.
[[nodiscard]] uint64_t gltf_mode(const Json& primitive);

/// The attributes of a primitive that have the names wanted, and its indices. Fails if it has no positions. `json`: the
/// file, `stated`: the primitive in it.
Result<PrimitiveValues> read_gltf_primitive(const Json& json, const Json& stated,
                                            const std::vector<std::string>& wanted, GltfBuffers& buffers);

}  // namespace surfcast::scan
