#pragma once

#include <cmath>
#include <numbers>

namespace surfcast::surfel {

/// Radius of a surfel over the spacing h of its samples, for evenly sampled surfaces. The radius of such a surfel is
/// the mean distance to its six nearest neighbours (scan/spacing.h).
inline constexpr double kRadiusOverSpacing = 1.08;

/// The factor by which every kernel of an even sampling is multiplied so that the mean over the surface of the sum of
/// kernels is 1. `sigma` is the standard deviation of the kernel in units of the surfel radius.
inline double even_sampling_weight(double sigma) {
  const double spacings = sigma * kRadiusOverSpacing;
  return 1 / (2 * std::numbers::pi * spacings * spacings);
}

/// The factor by which the weights s_k are multiplied for the same purpose. The weights alone make the sum 1 at the
/// centres of the surfels, where the sum of narrow kernels is largest. A pixel that covers many surfels sees the mean
/// instead.
inline double per_surfel_scale(double sigma) {
  const double spacings = sigma * kRadiusOverSpacing;
  const double line = 1 + 2 * std::exp(-0.5 / (spacings * spacings)) + 2 * std::exp(-2 / (spacings * spacings));
  return line * line * even_sampling_weight(sigma);  // the sum at a point of a square lattice is separable
}

}  // namespace surfcast::surfel
