#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "mesh/gltf_buffers.h"

namespace surfcast::mesh {

/// A primitive as its attributes are named in glTF.
struct PrimitiveValues {
  std::map<std::string, AccessorValues> attributes;
  std::vector<uint32_t> indices;  ///< of corners
};

/// Decodes a primitive of KHR_draco_mesh_compression. `ids`: the unique id of each attribute that is wanted. Integers
/// are not normalised yet.
Result<PrimitiveValues> decode_draco(Bytes bytes, const std::map<std::string, uint32_t>& ids);

}  // namespace surfcast::mesh
