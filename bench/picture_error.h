#pragma once

#include <cmath>
#include <limits>

#include "picture/picture.h"

namespace surfcast::bench {

/// Peak signal-to-noise ratio of two 8 bit pictures of the same size, in dB, over all channels of the pixels that are
/// covered in at least one of them. Infinite when the pictures are equal.
inline double psnr(const picture::Image& a, const picture::Image& b) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
    if (a.pixels[i + 3] == std::byte{0} && b.pixels[i + 3] == std::byte{0}) continue;
    for (size_t c = 0; c < 3; ++c) {
      sum += std::pow(std::to_integer<int>(a.pixels[i + c]) - std::to_integer<int>(b.pixels[i + c]), 2);
    }
    count += 3;
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / sum);
}

}  // namespace surfcast::bench
