#include "gaussian/gaussian_source.h"

#include <cmath>

namespace surfcast::gaussian {

Gaussians make_gaussians(uint64_t count, int degree) {
  Gaussians gaussians;
  gaussians.positions.resize(count);
  gaussians.scales.resize(count);
  gaussians.rotations.resize(count);
  gaussians.opacities.resize(count);
  gaussians.harmonics.resize(count * harmonics_of(degree) * 3);
  return gaussians;
}

double rounded_to_float(double value) {
  // GCC 12 leaves the rounding out where it vectorizes two conversions to float and back; volatile keeps it.
  const volatile auto rounded = static_cast<float>(value);
  return rounded;
}

float opacity_of_logit(double logit) {
  return static_cast<float>(1 / (1 + std::exp(-logit)));
}

}  // namespace surfcast::gaussian
