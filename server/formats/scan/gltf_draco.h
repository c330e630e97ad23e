#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/gltf_buffers.h"

namespace surfcast::scan {

/// A primitive as its attributes are named in glTF.
struct PrimitiveValues {
  std::map<std::string, AccessorValues> attributes;
  std::vector<uint32_t> indices;  ///< of corners
};

/// Whether the faces of Draco data are wanted, or its points alone.
enum class DracoGeometry { kFaces, kPoints };

/// Decodes a primitive of KHR_draco_mesh_compression. `ids`: the unique id of each attribute that is wanted. Integers
/// are not normalised yet. Of points the indices count up.
Result<PrimitiveValues> decode_draco(std::span<const std::byte> bytes, const std::map<std::string, uint32_t>& ids,
                                     DracoGeometry geometry);

}  // namespace surfcast::scan
