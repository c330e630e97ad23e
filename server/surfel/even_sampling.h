#pragma once

#include <cmath>
#include <numbers>

namespace surfcast::surfel {

/// A surfel's radius on an even sampling of spacing h: there it is the mean distance to its six nearest neighbours.
inline constexpr double kRadiusOverSpacing = 1.08;

/// What every kernel of an even sampling is to be multiplied with for the mean of their sum over the surface to be 1.
/// `sigma` is the kernel's deviation in units of the surfels' radius.
inline double even_sampling_weight(double sigma) {
  const double spacings = sigma * kRadiusOverSpacing;
  return 1 / (2 * std::numbers::pi * spacings * spacings);
}

/// What the weights s_k are to be multiplied with for the same. They make the sum 1 at the surfels' centres, where that
/// of a narrow kernel is largest; pixels that hold many surfels see its mean.
inline double per_surfel_scale(double sigma) {
  const double spacings = sigma * kRadiusOverSpacing;
  const double line = 1 + 2 * std::exp(-0.5 / (spacings * spacings)) + 2 * std::exp(-2 / (spacings * spacings));
  return line * line * even_sampling_weight(sigma);  // the sum at a point of a square lattice is a product of two lines
}

}  // namespace surfcast::surfel
