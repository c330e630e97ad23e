#pragma once

#include <span>
#include <vector>

#include "geometry/box.h"
#include "geometry/camera.h"

namespace surfcast::selection {

/// What a pixel shows, as inverses of the camera z: from the front surface to that which makes the pixel opaque.
struct DepthRange {
  float front = 0;   ///< 0: nothing is shown
  float opaque = 0;  ///< 0: the pixel is not opaque
};

/// The depths that the pixels of a picture show, to find out what is seen of a block: what is behind them is hidden
/// (an occlusion map: Greene 1993, Zhang 1997), and in front of them is nothing.
class VisibleDepths {
 public:
  /// Of a picture whose surfels are up to `spacing` pixels apart. Every pixel is to be entered before the depths are
  /// used. Sizes in pixels.
  VisibleDepths(int width, int height, double spacing);

  /// Enters a row of pixels, from the pixel (x, y) on.
  void enter(int x, int y, std::span<const DepthRange> pixels);

  /// The share of the pixels of a box in which something is shown that may lie in the box: of a large box only some
  /// pixels are looked at, evenly distributed. The box is grown by `margin` world units on all sides. 1 for a box
  /// beside the eye. `frame`: of the picture.
  [[nodiscard]] double share_of(const geometry::Box& box, double margin, const geometry::CameraFrame& frame) const;

  /// Whether a surfel may be shown by its centre: in pixels from the top left corner, moved into the picture if it is
  /// outside, and at this camera z, which is positive.
  [[nodiscard]] bool may_show(const glm::dvec2& pixel, double z, const geometry::CameraFrame& frame) const;

 private:
  double spacing_;
  int cell_;                       ///< side of a cell, pixels
  int across_;                     ///< cells in a row
  int down_;                       ///< rows of cells
  std::vector<DepthRange> cells_;  ///< what any pixel of the cell shows
};

}  // namespace surfcast::selection
