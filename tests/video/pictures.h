#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "picture/picture.h"

namespace surfcast::video {

/// An image of 8 bits whose pixels are `color(x, y, channel)`.
template <typename Color>
picture::Image image_of(int width, int height, Color color) {
  picture::Image image{width, height, picture::PixelFormat::kSrgb8, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int channel = 0; channel < 3; ++channel)
        image.pixels.push_back(static_cast<std::byte>(color(x, y, channel)));
      image.pixels.push_back(std::byte{255});
    }
  }
  return image;
}

/// Smooth waves of all three colours, shifted by `shift` pixels.
inline picture::Image waves(int width, int height, double shift) {
  return image_of(width, height, [shift](int x, int y, int channel) {
    return std::lround(127 + 60 * std::sin((x + shift) * 0.05 + channel) + 50 * std::cos(y * 0.07 - channel));
  });
}

inline picture::Image noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  return image_of(width, height, [&random](int, int, int) { return random() & 255U; });
}

}  // namespace surfcast::video
