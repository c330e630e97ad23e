#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

namespace surfcast::warp {

/// A picture of 4 bytes a pixel, in rows from top to bottom: red, green and blue of sRGB in any order, and a byte that
/// does not count.
struct Pixels {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> bytes;
};

/// The four bytes of a pixel.
using Color = uint32_t;

inline Color color_at(const uint8_t* pixel) {
  Color color = 0;
  std::memcpy(&color, pixel, sizeof color);
  return color;
}

/// A channel of a colour, of 0 to 2.
inline int channel(Color color, int number) {
  return static_cast<int>(color >> (8 * number) & 0xff);
}

}  // namespace surfcast::warp
