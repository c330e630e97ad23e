#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "warp/depth_plane.h"

namespace surfcast::warp {

/// A point of a frame.
struct MeshVertex {
  glm::vec2 pixel{0};  ///< from the upper left corner of the frame
  float inverse = 0;   ///< 1 / depth; 0: infinitely far
  /// Of kNear and kFar: 1 where the texel is the surface in front, 0 where it is what is behind. Interpolated, it is at
  /// least a half in the texels of the surface in front. Of kSurroundings: 1 at the border of the frame, 0 farthest
  /// out.
  float front = 0;
  size_t fill_texel = 0;  ///< of kFar, kFill and kSurroundings: the texel whose fill colour is used, see fill_colors.h
};

/// A texel beside an outline has pixels of the surface in front, and may have pixels of what is behind. There a frame
/// is two sheets, one at each depth. Pixels that have the colour of what is behind are on the far one.
enum class Sheet : uint8_t {
  kSurface,       ///< away from outlines
  kNear,          ///< the surface in front
  kFar,           ///< what is behind it, also where the frame shows the surface in front
  kFill,          ///< what opens between the two
  kSurroundings,  ///< beyond the border of the frame
};

/// Three neighbouring places.
struct MeshTriangle {
  std::array<MeshVertex, 3> corners;
  Sheet sheet = Sheet::kSurface;
  bool background = false;  ///< of kSurface: infinitely far
  glm::vec2 far{0};         ///< of kNear and kFar: where the frame shows what is behind, pixels
};

/// The triangles of a frame with this depth and `width` x `height` pixels. They reach to the borders of the frame.
using WarpMesh = std::vector<MeshTriangle>;
WarpMesh make_warp_mesh(const DepthPlane& depth, int width, int height);

}  // namespace surfcast::warp
