#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "surfel/surfel_cloud.h"

namespace surfcast::simplify {

/// How far a simplified surface may be from the samples that a surfel stands for.
struct ErrorBound {
  double degrees = 2;            ///< of nine in ten normals
  std::optional<double> height;  ///< of every sample along the normal, world units; none: kHeightPerAngle
};

/// Without a stated height: the bound of the angle, in radians, times this and the radius of the neighbourhood. A
/// surface whose normals are wrong by an angle is off by as much times the distance.
inline constexpr double kHeightPerAngle = 2;

/// What became of the samples.
struct SimplifyReport {
  size_t samples = 0;  ///< of surfaces; scatter stays as it is
  size_t points = 0;   ///< surfels that stand for them
  size_t curved = 0;   ///< of these, with curvature
  size_t kept = 0;     ///< of these, samples that no surface fits
  double degrees = 0;  ///< largest 90th percentile of a surfel's normals
  double height = 0;   ///< largest height, world units
  bool pays = false;   ///< false: the cloud is unchanged
  std::string reason;  ///< why it does not pay
};

/// Replaces the samples of smooth surfaces by fewer surfels with curvature, largest first (Kalaiah and Varshney 2001,
/// section 4, with a bound of the error in place of their redundancy). The neighbourhood of a sample grows while one
/// osculating surface keeps the bound in it; noise is no error of the surface, so that the residual may be a twentieth
/// above that of the smallest neighbourhood. Every sample is within 0.62 of the neighbourhood of a surfel.
///
/// Where surfels would stand for fewer than 20 samples on average, those that do are replaced by their samples. Where
/// it does not pay even so the cloud is unchanged: fewer than half of the surfels keep the bound as a plane or need
/// their curvature for it, or more than half of the samples would be left.
///
/// Positions and normals are those of the fits, colours are means, other attributes those of the sample nearest to the
/// centre of the neighbourhood. Deterministic.
SimplifyReport simplify(const ErrorBound& bound, surfel::SurfelCloud& cloud);

}  // namespace surfcast::simplify
