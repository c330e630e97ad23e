#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

#include "gaussian/gaussian_codes.h"

namespace surfcast::gaussian {

/// Texels of a Gaussian with harmonics of this degree.
[[nodiscard]] constexpr uint32_t texels_per_gaussian(int degree) {
  constexpr uint32_t kFirst = 9;    // coefficients in the first two texels
  constexpr uint32_t kOthers = 16;  // in each other one
  const auto coefficients = static_cast<uint32_t>(varying_coefficients(degree));
  return 2 + (coefficients <= kFirst ? 0 : (coefficients - kFirst + kOthers - 1) / kOthers);
}

/// Texels of so many Gaussians. None crosses the end of a page.
[[nodiscard]] constexpr uint64_t packed_texels(uint64_t count, int degree, uint32_t page) {
  const uint32_t each = texels_per_gaussian(degree);
  const uint64_t in_page = page / each;
  return count / in_page * page + count % in_page * each;
}

/// Gaussians as the GPU reads them (shaders/shared/gaussian_layout.h).
struct PackedGaussians {
  std::vector<glm::uvec4> texels;
  double log2_zero = 0;  ///< a deviation is 2^(log2_zero + code / kScaleSteps) world units
};

PackedGaussians pack_gaussians(const GaussianCodes& codes, uint32_t page);

}  // namespace surfcast::gaussian
