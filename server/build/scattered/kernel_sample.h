#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "ellipsoid/tensor.h"
#include "scattered/field_options.h"

namespace surfcast::scattered {

/// The profile of a kernel over r^2 = d^T C^-1 d, with 1 at the centre.
enum class Profile {
  kGaussian,  ///< exp(-r^2 / 2), C is the covariance; 0 beyond kGaussianReach
  kSpline,    ///< the cubic spline of Monaghan and Lattanzio (1985), C is h^2; 0 beyond r = 2
};

/// A Gaussian is 4e-5 of its peak here.
inline constexpr double kGaussianReach = 4.5;
/// The variance of the spline along an axis, in units of h^2 (Dehnen and Aly 2012, table 1).
inline constexpr double kSplineVariance = 0.3;

[[nodiscard]] constexpr Profile profile_of(KernelSize meaning) {
  return meaning == KernelSize::kDeviation || meaning == KernelSize::kCovariance ? Profile::kGaussian
                                                                                 : Profile::kSpline;
}

/// The value of a profile at r^2.
[[nodiscard]] double profile_at(Profile profile, double squared);
/// Where it ends, in r.
[[nodiscard]] constexpr double reach_of(Profile profile) {
  return profile == Profile::kGaussian ? kGaussianReach : 2;
}
/// Its integral over space for C = 1.
[[nodiscard]] double integral_of(Profile profile);

/// A sample of a field with the kernel around it.
struct KernelSample {
  glm::dvec3 centre{0};              ///< world
  ellipsoid::SymmetricTensor shape;  ///< C, squared world units
  double value = 0;
  double amplitude = 1;  ///< the kernel's value at its centre

  /// Half the sides of the box around the kernel, world units.
  [[nodiscard]] glm::dvec3 half_extent(Profile profile) const;
};

/// The standard deviation along the kernel's shortest axis, world units.
[[nodiscard]] double least_deviation(const KernelSample& sample, Profile profile);

/// Widens a kernel along all axes until its least deviation is at least that. With `keeps_integral`, its amplitude
/// falls so that its integral stays, as a filter would leave it. True if it was narrower.
bool widen(double deviation, Profile profile, bool keeps_integral, KernelSample& sample);

}  // namespace surfcast::scattered
