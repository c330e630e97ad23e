#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "picture/depth_map.h"

namespace surfcast::encode {

/// A depth map as clients receive it: wire::DepthPlane.
struct EncodedDepth {
  int width = 0;     ///< texels
  int height = 0;    ///< texels
  int cell = 0;      ///< pixels
  double first = 0;  ///< inverse depth of code 1, per world unit
  double last = 0;   ///< inverse depth of code 255
  std::vector<std::byte> codes;
};

/// Encodes a depth map with 8 bits a texel (protocol/PROTOCOL.md, Depth). A map that takes more than `most_bytes` is
/// made coarser until it does not. None if it has no surface.
std::optional<EncodedDepth> encode_depth(picture::DepthMap map, size_t most_bytes);

}  // namespace surfcast::encode
