#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/json_access.h"

namespace surfcast::scan {

/// Fails for a file that needs an extension beside those of geometry that are read, `also`, and those that only add to
/// materials, lights and metadata.
Status check_gltf_extensions(const Json& json, std::span<const std::string_view> also);

/// Calls `use` for the nodes of the scene that a glTF file shows, depth first, each with the product of its matrix and
/// those above it. Ends with the first error.
Status visit_gltf_nodes(const Json& json,
                        const std::function<Status(const Json& node, const glm::dmat4& to_world)>& use);

}  // namespace surfcast::scan
