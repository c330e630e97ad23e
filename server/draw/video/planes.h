#pragma once

#include <cstdint>
#include <vector>

#include "picture/picture.h"

namespace surfcast::video {

/// A picture as VP9 takes it: luma, and two differences of colour for each 2 x 2 pixels, by BT.709 in limited range (16
/// to 235 and 16 to 240).
struct Planes {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> luma;  ///< width x height
  std::vector<uint8_t> blue;  ///< half_of(width) x half_of(height)
  std::vector<uint8_t> red;   ///< likewise
};

/// The last column or row of an odd side has differences of its own.
[[nodiscard]] inline int half_of(int side) {
  return (side + 1) / 2;
}

/// The planes of an sRGB image of 8 bits. Keeps the memory of `planes` where it suffices.
void fill_planes(const picture::Image& image, Planes& planes);

}  // namespace surfcast::video
