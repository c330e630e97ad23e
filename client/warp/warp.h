#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "warp/warp_mesh.h"

namespace surfcast::warp {

/// A picture of 4 bytes a pixel, in rows from top to bottom: red, green and blue of sRGB in any order, and a byte that
/// does not count.
struct Pixels {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> bytes;
};

/// A frame that can be warped. A frame without surfaces has no mesh.
struct WarpFrame {
  Pixels pixels;
  geometry::CameraFrame camera;  ///< of as many pixels
  WarpMesh mesh;
  bool seen_through = false;  ///< DepthPlane::seen_through
};

/// What `target` sees, by the frames that are there: the newest one, which decides what is where, and a former one at
/// rest, which is sharper, where both agree. `background`: the pixels where there is nothing. Uses all cores.
Pixels warp(const WarpFrame& newest, const WarpFrame* rest, const geometry::CameraFrame& target,
            const std::array<uint8_t, 4>& background);

}  // namespace surfcast::warp
