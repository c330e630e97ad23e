#pragma once

#include <cmath>
#include <numbers>

namespace surfcast::surfel {

/// Radius of a surfel over the spacing h of its samples, for an even sampling, in which a surfel has the area h^2. The
/// radius is the mean distance to the six nearest neighbours (scan/spacing.h): 1.075 h on a hexagonal lattice, 1.09 h
/// on a jittered grid.
inline constexpr double kRadiusOverSpacing = 1.08;
/// The same ratio on a square grid: of the six nearest neighbours four are at h and two at sqrt(2) h.
inline constexpr double kGridRadiusOverSpacing = (4 + 2 * std::numbers::sqrt2) / 6;

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
