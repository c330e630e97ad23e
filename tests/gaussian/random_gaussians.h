#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>

#include "gaussian/gaussian_source.h"

namespace surfcast::gaussian {

/// Gaussians of all shapes in a cube, with harmonics up to `degree`.
inline Gaussians random_gaussians(uint64_t count, int degree, uint32_t seed = 1) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto real = [&](double low, double high) { return static_cast<float>(uniform(low, high)); };
  Gaussians gaussians = make_gaussians(count, degree);
  for (size_t i = 0; i < count; ++i) {
    gaussians.positions[i] = {uniform(-1, 1), uniform(-1, 1), uniform(5, 6)};
    for (int axis = 0; axis < 3; ++axis) gaussians.scales[i][axis] = std::exp2(real(-9, -4));
    gaussians.rotations[i] = glm::normalize(glm::quat(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)));
    gaussians.opacities[i] = real(0, 1);
  }
  for (float& c : gaussians.harmonics) c = real(-0.3, 0.3);
  return gaussians;
}

}  // namespace surfcast::gaussian
