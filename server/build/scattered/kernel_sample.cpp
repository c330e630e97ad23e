#include "scattered/kernel_sample.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surfcast::scattered {
namespace {

double least_squared(const ellipsoid::SymmetricTensor& shape) {
  const ellipsoid::EigenSystem system = ellipsoid::eigen_system(shape);
  return std::max(std::min({system.values[0], system.values[1], system.values[2]}), 0.0);
}

double determinant(const ellipsoid::SymmetricTensor& c) {
  return c.xx * (c.yy * c.zz - c.yz * c.yz) - c.xy * (c.xy * c.zz - c.yz * c.xz) + c.xz * (c.xy * c.yz - c.yy * c.xz);
}

/// Variance along an axis for C = 1.
constexpr double variance_of(Profile profile) {
  return profile == Profile::kGaussian ? 1 : kSplineVariance;
}

}  // namespace

double profile_at(Profile profile, double squared) {
  if (profile == Profile::kGaussian) {
    return squared < kGaussianReach * kGaussianReach ? std::exp(-0.5 * squared) : 0;
  }
  if (squared >= 4) return 0;
  const double q = std::sqrt(squared);
  if (q >= 1) return 0.25 * (2 - q) * (2 - q) * (2 - q);
  return 1 - squared * (1.5 - 0.75 * q);
}

double integral_of(Profile profile) {
  constexpr double kPi = std::numbers::pi;
  return profile == Profile::kGaussian ? 2 * kPi * std::sqrt(2 * kPi) : kPi;
}

glm::dvec3 KernelSample::half_extent(Profile profile) const {
  return reach_of(profile) * glm::dvec3(std::sqrt(shape.xx), std::sqrt(shape.yy), std::sqrt(shape.zz));
}

double least_deviation(const KernelSample& sample, Profile profile) {
  return std::sqrt(variance_of(profile) * least_squared(sample.shape));
}

bool widen(double deviation, Profile profile, bool keeps_integral, KernelSample& sample) {
  const double more = deviation * deviation / variance_of(profile) - least_squared(sample.shape);
  if (!(more > 0)) return false;
  const double before = determinant(sample.shape);
  for (double* diagonal : {&sample.shape.xx, &sample.shape.yy, &sample.shape.zz}) *diagonal += more;
  if (keeps_integral) sample.amplitude *= std::sqrt(std::max(before, 0.0) / determinant(sample.shape));
  return true;
}

}  // namespace surfcast::scattered
