#pragma once

#include <cstddef>
#include <optional>

#include "picture/depth_map.h"

namespace surfcast::encode {

/// Encodes a depth map with 8 bits a texel (protocol/PROTOCOL.md, Depth). A map that takes more than `most_bytes` is
/// made coarser until it does not. None if it has no surface.
std::optional<picture::EncodedDepth> encode_depth(picture::DepthMap map, size_t most_bytes);

}  // namespace surfcast::encode
