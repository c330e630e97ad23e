#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <span>

#include <tbb/parallel_for.h>

#include "geometry/camera.h"

namespace surfcast::lab {

/// A rectangle of pixels; `last` is exclusive.
struct PixelBox {
  int first_x = 0;
  int first_y = 0;
  int last_x = 0;
  int last_y = 0;

  [[nodiscard]] bool empty() const { return first_x >= last_x || first_y >= last_y; }
};

/// Whether a sphere is wholly beyond a side of the picture. It may contain the eye or be behind it.
inline bool beside_picture(const geometry::CameraFrame& frame, const glm::dvec3& centre, double radius) {
  const auto outside = [&](double along, double pixels) {
    const double tangent = 0.5 * pixels / frame.eta;
    return std::abs(along) - tangent * centre.z > radius * std::sqrt(1 + tangent * tangent);
  };
  return outside(centre.x, frame.width) || outside(centre.y, frame.height);
}

/// Upper bound of a surfel's extent, in radii: that of its kernel.
inline constexpr double kLargestExtent = 1.1;
/// Discs reach at most this far on the screen beyond their own radius, pixels (shaders/shared/kernel.h: 0.6).
inline constexpr double kPrefilterReach = 1;

/// The pixels whose centres are within `margin` pixels of the picture of a sphere (centre in the camera frame, radius
/// in world units). All pixels if the sphere is about to reach the plane of the eye and the picture; none if it is
/// behind that plane.
inline PixelBox pixels_within(const geometry::CameraFrame& frame, const glm::dvec3& centre, double radius,
                              double margin) {
  if (centre.z + radius <= 0) return {};
  if (centre.z <= 1.5 * radius) {
    if (beside_picture(frame, centre, radius + margin * 2.5 * radius / frame.eta)) return {};
    return {0, 0, frame.width, frame.height};
  }
  const auto range = [&](double along, double middle, int size, int& first, int& last) {
    const double tangent = std::abs(along) / centre.z;
    const double reach =
        frame.eta * radius * (1 + tangent) / (centre.z - radius) + margin * centre.z / (centre.z - radius);
    first = static_cast<int>(std::clamp(std::floor(middle - reach), 0.0, double{1} * size));
    last = static_cast<int>(std::clamp(std::ceil(middle + reach), 0.0, double{1} * size));
  };
  const glm::dvec2 middle = frame.project(centre);
  PixelBox box;
  range(centre.x, middle.x, frame.width, box.first_x, box.last_x);
  range(centre.y, middle.y, frame.height, box.first_y, box.last_y);
  return box;
}

/// Calls `use(item, x, y)` for every pixel of every item's box, on all threads. Calls for the same pixel do not overlap
/// and come in the order of the items.
template <typename Use>
void for_each_pixel(std::span<const PixelBox> boxes, int height, const Use& use) {
  constexpr int kRows = 16;
  tbb::parallel_for(0, (height + kRows - 1) / kRows, [&](int band) {
    for (size_t i = 0; i < boxes.size(); ++i) {
      const int last = std::min(boxes[i].last_y, (band + 1) * kRows);
      for (int y = std::max(boxes[i].first_y, band * kRows); y < last; ++y) {
        for (int x = boxes[i].first_x; x < boxes[i].last_x; ++x) use(i, x, y);
      }
    }
  });
}

}  // namespace surfcast::lab
