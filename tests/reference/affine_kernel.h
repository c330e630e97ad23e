#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast::reference {

/// A kernel whose projection is linearised at its centre (Zwicker 2002, equations 28 to 33), for comparisons and for
/// pictures as Gaussian models are trained. Its footprint is one ellipse on the screen.
class AffineKernel {
 public:
  /// As RayKernel, but for the added `variance` in square pixels, and for `limit`: the largest tangent |x / z|, |y / z|
  /// at which the projection is linearised. The centre must be in front of the eye's plane.
  AffineKernel(const glm::dvec3& centre, const glm::dmat3& factor, double eta, double variance,
               const glm::dvec2& limit = glm::dvec2(1e300));

  /// Squared Mahalanobis distance of a pixel from the centre; `d` is the pixel's ray with z = 1.
  [[nodiscard]] double r2(const glm::dvec3& d) const;
  /// Integral of the kernel along the ray, relative to its peak value, world units (equation 33).
  [[nodiscard]] double length(const glm::dvec3& d) const;
  /// sqrt(det S0 / det S): what the added variance leaves of the peak.
  [[nodiscard]] double compensation() const { return compensation_; }
  /// Variance along x and y and covariance of the footprint with what was added, square pixels.
  [[nodiscard]] glm::dvec3 footprint() const { return s_; }

 private:
  glm::dvec2 centre_;  ///< o.xy / o.z
  glm::dvec3 s_;
  double det_ = 0;
  double eta_ = 0;
  double compensation_ = 0;
  double peak_ = 0;  ///< of length()
};

}  // namespace surfcast::reference
