#pragma once

#include <algorithm>
#include <vector>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::warp {

/// The depth of a frame, as the server sends it: a texel for each square of `cell` x `cell` pixels, in rows from top to
/// bottom.
struct DepthPlane {
  int width = 0;               ///< texels
  int height = 0;              ///< texels
  int cell = 0;                ///< pixels
  std::vector<float> inverse;  ///< 1 / depth of the nearest surface, per world unit; 0: background
  bool seen_through = false;   ///< pixels may show things at several depths
};

/// The most by which the inverse depths of two texels beside each other may differ on one surface: 3 % of the larger
/// one for each pixel of a side.
inline float surface_step(float a, float b, int cell) {
  constexpr float kStepPerPixel = 0.03F;
  return kStepPerPixel * static_cast<float>(cell) * std::max(a, b);
}

/// The depth of a frame whose picture has `width` x `height` pixels. Fails where it does not fit to the picture, and
/// where it is damaged. A plane has at most 2^20 texels.
Result<DepthPlane> decode_depth(const wire::DepthPlane& plane, int width, int height);

}  // namespace surfcast::warp
