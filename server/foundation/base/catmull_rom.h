#pragma once

#include <array>

namespace surfcast {

/// Weights of four samples at the fraction `x` between the second and the third: Catmull and Rom, or cubic convolution
/// (Keys 1981, equation 4, with a = -1/2).
constexpr std::array<double, 4> catmull_rom_weights(double x) {
  return {((2 - x) * x - 1) * x / 2, ((3 * x - 5) * x * x + 2) / 2, ((4 - 3 * x) * x + 1) * x / 2, (x - 1) * x * x / 2};
}

}  // namespace surfcast
