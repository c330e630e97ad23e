#include "reference/resampling_filter.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/infinity.h"

namespace surfcast::reference {
std::optional<Splat> Splat::make(const glm::dvec3& o, const glm::dvec3& n, double radius, double eta, double prefilter,
                                 const KernelParameters& kernel) {
  const bool valid = finite(o) && finite(n) && glm::dot(n, n) > 0.5 && radius > 0 && std::isfinite(radius);
  if (!valid) return std::nullopt;
  Splat splat;
  splat.o_ = o;
  splat.n_ = glm::normalize(n);
  splat.eta_ = eta;
  splat.scale_ = eta / o.z;
  splat.centre_ = glm::dvec2(o) / o.z;
  splat.prefilter_ = prefilter;
  splat.sigma_ = kernel.sigma * radius;
  splat.disc_radius_ = kernel.visibility_radius * radius;
  splat.push_ = kernel.visibility_depth * radius + kernel.visibility_footprint * std::max(o.z, 0.0) / eta;
  splat.disc_pixels_ = kernel.visibility_pixels;
  const double widest = std::sqrt(std::max(kernel.cutoff_magnified, kernel.cutoff_minified)) * splat.sigma_;
  splat.extent_ = std::max(widest, splat.disc_radius_);
  splat.depth_range_ = splat.extent_ * std::sqrt(std::max(0.0, 1 - splat.n_.z * splat.n_.z));
  if (o.z + splat.depth_range_ <= 0) return std::nullopt;
  splat.reaches_eye_plane_ = o.z <= 1.5 * splat.extent_;
  if (!splat.reaches_eye_plane_) {
    const double slope = std::hypot(splat.n_.x, splat.n_.y) * o.z / std::abs(glm::dot(splat.n_, o));
    splat.push_ += kernel.visibility_pixels * std::min(slope, kernel.visibility_slope) * o.z / eta;
  }
  const double gain = splat.reaches_eye_plane_ ? 1 : splat.fragment(o / o.z).gain;
  splat.cutoff_ = glm::mix(kernel.cutoff_minified, kernel.cutoff_magnified, gain);
  const bool one_cutoff = kernel.cutoff_minified == kernel.cutoff_magnified;
  splat.rim_ = one_cutoff ? 0 : gain * std::exp(-0.5 * splat.cutoff_);
  return splat;
}

// v^T S^-1 v with S = s^2 J J^T + rho^2 I, J the secant Jacobian in units of s, written as sums of squares so that
// neither an inverse of J nor a difference of large terms occurs:
//   det(S) r2 = s^2 |m x n|^2 + rho^2 |v|^2,           m = (v.y, -v.x, d.y v.x - d.x v.y) = (eta / o.z) (d x o)
//   det(S)    = s^4 (n.d)^2 + s^2 rho^2 T + rho^4,     T = trace(J J^T) = 2 + |d.xy|^2 - |n.xy - d.xy n.z|^2
Fragment Splat::quadratic(const glm::dvec3& d, double s, double rho) const {
  const glm::dvec2 v = eta_ * (glm::dvec2(d) - centre_);
  const glm::dvec3 m{v.y, -v.x, d.y * v.x - d.x * v.y};
  const glm::dvec3 mn = glm::cross(m, n_);
  const glm::dvec2 an{n_.x - d.x * n_.z, n_.y - d.y * n_.z};
  const double nd = glm::dot(n_, d);
  const double trace = 2 + d.x * d.x + d.y * d.y - glm::dot(an, an);
  const double s2 = s * s;
  const double rho2 = rho * rho;
  const double det = s2 * s2 * nd * nd + s2 * rho2 * trace + rho2 * rho2;
  return {(s2 * glm::dot(mn, mn) + rho2 * glm::dot(v, v)) / det, s2 * std::abs(nd) / std::sqrt(det)};
}

Fragment Splat::object_space(const glm::dvec3& d, double deviation) const {
  const double t = glm::dot(n_, o_) / glm::dot(n_, d);
  if (!(t > 0) || !std::isfinite(t)) return {kInfinity, 1};
  const glm::dvec3 u = (t * d - o_) / deviation;
  return {glm::dot(u, u), 1};
}

Fragment Splat::fragment(const glm::dvec3& d) const {
  if (reaches_eye_plane_) return object_space(d, sigma_);
  return quadratic(d, sigma_ * scale_, prefilter_);
}

double Splat::gain(const glm::dvec3& d, double prefilter) const {
  return reaches_eye_plane_ ? 1 : quadratic(d, sigma_ * scale_, prefilter).gain;
}

bool Splat::opaque(const glm::dvec3& d) const {
  const Fragment f =
      reaches_eye_plane_ ? object_space(d, disc_radius_) : quadratic(d, disc_radius_ * scale_, disc_pixels_);
  return f.r2 <= 1;
}

double Splat::plane_depth(const glm::dvec3& d) const {
  const double t = glm::dot(n_, o_) / glm::dot(n_, d);
  return t > 0 ? t : kInfinity;
}

double Splat::fragment_depth(const glm::dvec3& d) const {
  return reaches_eye_plane_ ? plane_depth(d) : std::min(plane_depth(d), o_.z + depth_range_);
}

Splat::DiscDepth Splat::disc_depth(const glm::dvec3& d) const {
  const double depth = plane_depth(d);
  if (reaches_eye_plane_) return {depth, depth + push_};
  const double limited = std::max(depth, o_.z - depth_range_);
  return {limited, limited * (1 + push_ / o_.z)};
}

// A pixel of the splat sees a point d.xy = (o.xy + U.xy + b o.z / eta) / (o.z + U.z) with U on the disc and b within
// the prefilter's reach: v^T (A + B)^-1 v is the least a^T A^-1 a + b^T B^-1 b over v = a + b.
Splat::Bounds Splat::bounds() const {
  const glm::dvec3 reach = extent_ * glm::sqrt(glm::max(glm::dvec3(0), 1.0 - n_ * n_));
  const double pixels = reaches_eye_plane_ ? 0 : std::max(prefilter_ * std::sqrt(cutoff_), disc_pixels_);
  const double pad = pixels * o_.z / eta_;
  const double near = reaches_eye_plane_ ? 0 : o_.z - reach.z;  // at the eye's plane, x / 0 is the infinite bound
  const double far = o_.z + reach.z;
  const auto low = [&](double x) { return x < 0 ? x / near : x / far; };
  const auto high = [&](double x) { return x > 0 ? x / near : x / far; };
  return {{low(o_.x - reach.x - pad), low(o_.y - reach.y - pad)},
          {high(o_.x + reach.x + pad), high(o_.y + reach.y + pad)}};
}

}  // namespace surfcast::reference
