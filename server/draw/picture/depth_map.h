#pragma once

#include <cstddef>
#include <vector>

namespace surfcast::picture {

/// The depth of a picture, coarse: a texel for each square of `cell` x `cell` pixels, from the upper left corner on, in
/// rows from top to bottom; squares at the right and at the lower border may be cut off. A texel is the nearest surface
/// in its square. Nothing is in it if the depth is not known.
struct DepthMap {
  int width = 0;               ///< texels
  int height = 0;              ///< texels
  int cell = 0;                ///< pixels
  std::vector<float> inverse;  ///< 1 / camera z, per world unit; 0: nothing but background
  bool seen_through = false;   ///< pixels may show things at several depths, of which the map has one
};

/// A depth map as clients receive it: wire::DepthPlane.
struct EncodedDepth {
  int width = 0;     ///< texels
  int height = 0;    ///< texels
  int cell = 0;      ///< pixels
  double first = 0;  ///< inverse depth of code 1, per world unit
  double last = 0;   ///< inverse depth of code 255
  std::vector<std::byte> codes;
  bool seen_through = false;  ///< as in DepthMap
};

/// An empty map for a picture of this many pixels, with at most `texels` texels a side.
inline DepthMap empty_depth_map(int width, int height, int texels) {
  const int longer = width > height ? width : height;
  const int cell = (longer + texels - 1) / texels;
  DepthMap map{(width + cell - 1) / cell, (height + cell - 1) / cell, cell, {}, false};
  map.inverse.assign(static_cast<size_t>(map.width) * static_cast<size_t>(map.height), 0.0F);
  return map;
}

}  // namespace surfcast::picture
