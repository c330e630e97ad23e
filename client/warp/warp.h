#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "warp/depth_plane.h"
#include "warp/pixels.h"
#include "warp/warp_mesh.h"

namespace surfcast::warp {

/// A frame that can be warped. A frame without surfaces has no mesh.
struct WarpFrame {
  Pixels pixels;
  geometry::CameraFrame camera;  ///< of as many pixels
  WarpMesh mesh;
  std::vector<Color> fill_colors;  ///< of the texels of its depth, see fill_colors.h
  bool seen_through = false;       ///< DepthPlane::seen_through
};

/// `depth`: that of the frame.
WarpFrame make_warp_frame(Pixels pixels, const geometry::CameraFrame& camera, const DepthPlane& depth);

/// What `target` sees, by the frames that are there: the newest one, which decides what is where, and a former one at
/// rest, which is sharper, where both agree. `background`: the pixels where there is nothing. Uses all cores.
Pixels warp(const WarpFrame& newest, const WarpFrame* rest, const geometry::CameraFrame& target,
            const std::array<uint8_t, 4>& background);

}  // namespace surfcast::warp
