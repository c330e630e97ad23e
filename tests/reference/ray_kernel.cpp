#include "reference/ray_kernel.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "reference/infinity.h"

namespace surfcast::reference {
namespace {

double squared_length(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// Its rows are the cross products of the columns of M; also for singular M.
glm::dmat3 adjugate(const glm::dmat3& m) {
  return glm::transpose(glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])));
}

/// Integral of the standard normal distribution up to x.
double normal_integral(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

}  // namespace

double share_between(const KernelOnRay& kernel, double z0, double z1) {
  if (!(kernel.deviation > 0)) return kernel.depth >= z0 && kernel.depth < z1 ? 1 : 0;
  return normal_integral((z1 - kernel.depth) / kernel.deviation) -
         normal_integral((z0 - kernel.depth) / kernel.deviation);
}

RayKernel::RayKernel(const glm::dvec3& centre, const glm::dmat3& factor, double eta, double prefilter)
    : o_(centre),
      transposed_(glm::transpose(factor)),
      adjugate_(adjugate(factor)),
      determinant_(std::abs(glm::determinant(factor))),
      pixel_(prefilter / eta),
      p_(pixel_ * o_.z * pixel_ * o_.z),
      flattened_(squared_length(adjugate_[0]) + squared_length(adjugate_[1])) {}

// With B = A V A^T, S in units of (eta / o.z)^2 is B + p I, and for 2 x 2 matrices adj(B + p I) = adj(B) + p I:
//   det S0      = det B = |adj(M) d|^2                              (Cauchy-Binet)
//   det S       = det B + p trace(B) + p^2,                         trace B = |M^T a1|^2 + |M^T a2|^2, a_i rows of A
//   det(S) r2   = w^T adj(B) w + p |w|^2 = |M^T (d x o)|^2 + p |w|^2
//   det(S) z    = adj(M) d . adj(M) o + p (o.z trace(B) + c.w) + p^2 o.z,   c = A V e_z
//   det(S) var  = det(V) + p (|adj(M) e_x|^2 + |adj(M) e_y|^2) + p^2 V_zz
KernelOnRay RayKernel::on_ray(const glm::dvec3& d) const {
  const glm::dvec3 a1 = transposed_ * glm::dvec3(1, 0, -d.x);
  const glm::dvec3 a2 = transposed_ * glm::dvec3(0, 1, -d.y);
  const glm::dvec3& a3 = transposed_[2];
  const glm::dvec2 w{o_.z * d.x - o_.x, o_.z * d.y - o_.y};
  const double trace = squared_length(a1) + squared_length(a2);
  const glm::dvec3 ad = adjugate_ * d;
  const double det0 = squared_length(ad);
  const double det = det0 + p_ * trace + p_ * p_;
  if (!(det > 0)) return {kInfinity, 0, 0, o_.z, 0};
  KernelOnRay result;
  result.r2 = (squared_length(transposed_ * glm::cross(d, o_)) + p_ * glm::dot(w, w)) / det;
  const double value = std::exp(-0.5 * result.r2);
  result.length = std::sqrt(2 * std::numbers::pi / det) * determinant_ * glm::length(d) * value;
  result.gain = std::sqrt(det0 / det) * value;
  const double shift = glm::dot(a1, a3) * w.x + glm::dot(a2, a3) * w.y;
  result.depth = (glm::dot(ad, adjugate_ * o_) + p_ * (o_.z * trace + shift) + p_ * p_ * o_.z) / det;
  const double variance = (determinant_ * determinant_ + p_ * flattened_ + p_ * p_ * squared_length(a3)) / det;
  result.deviation = std::sqrt(variance);
  return result;
}

bool RayKernel::behind(double cutoff) const {
  return o_.z <= -std::sqrt(cutoff * squared_length(transposed_[2]));
}

// r2 <= c requires v_x^2 <= c S_xx (and the same for y), both taken at the pixel: a quadratic in d.x. For an ellipse
// the bound is attained.
std::optional<RayKernel::Bounds> RayKernel::bounds(double cutoff) const {
  const double a = o_.z * o_.z - cutoff * squared_length(transposed_[2]);
  if (!(a > 0)) return std::nullopt;
  Bounds result{};
  for (int i = 0; i < 2; ++i) {
    const double half_b = o_[i] * o_.z - cutoff * glm::dot(transposed_[i], transposed_[2]);
    const double c = o_[i] * o_[i] - cutoff * (squared_length(transposed_[i]) + p_);
    const double root = std::sqrt(std::max(0.0, half_b * half_b - a * c));
    result.min[i] = (half_b - root) / a;
    result.max[i] = (half_b + root) / a;
  }
  return result;
}

}  // namespace surfcast::reference
