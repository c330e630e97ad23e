#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace surfcast::reference {

/// What one ray sees of a kernel.
struct KernelOnRay {
  double r2 = 0;         ///< squared Mahalanobis distance of the pixel from the kernel, prefilter included
  double length = 0;     ///< integral of the kernel along the ray, relative to its peak value; world units
  double gain = 0;       ///< of a kernel of opacity: sqrt(det S0 / det S) exp(-r2 / 2), in [0, 1]
  double depth = 0;      ///< where along the ray the kernel lies: the mean of its z; camera z
  double deviation = 0;  ///< standard deviation of its z
};

/// The share of a kernel between two depths along the ray.
double share_between(const KernelOnRay& kernel, double z0, double z1);

/// A Gaussian exp(-x^T V^-1 x / 2) with V = M M^T, seen in perspective.
///
/// Zwicker 2002, equation (33), with the Jacobian of the pixel's ray in place of that of the kernel's centre (equations
/// 28 to 31): exact for any field of view, distance and elongation. Symbols: o centre, camera frame; d = (x, y, 1) a
/// pixel's ray; A = [1 0 -x; 0 1 -y], which is the secant Jacobian in units of eta / o.z; p = (rho o.z / eta)^2 the
/// prefilter in the same units; w = o.z d.xy - o.xy the displacement of the pixel.
///
/// Every value is a quotient of sums of squares: nothing is inverted, no large terms are subtracted, o.z may be zero or
/// negative and M singular.
class RayKernel {
 public:
  /// `factor` is M, columns in the camera frame: the axes of the kernel times their standard deviations, world units.
  /// `prefilter` is rho, pixels.
  RayKernel(const glm::dvec3& centre, const glm::dmat3& factor, double eta, double prefilter);

  [[nodiscard]] KernelOnRay on_ray(const glm::dvec3& d) const;

  /// Bounds of d.xy over every ray with r2 <= cutoff. None if the kernel reaches the eye's plane: every ray may be.
  struct Bounds {
    glm::dvec2 min;
    glm::dvec2 max;
  };
  [[nodiscard]] std::optional<Bounds> bounds(double cutoff) const;
  /// Whether the kernel lies behind the eye, up to the cutoff.
  [[nodiscard]] bool behind(double cutoff) const;

 private:
  glm::dvec3 o_;
  glm::dmat3 transposed_;  ///< M^T
  glm::dmat3 adjugate_;    ///< adj(M) = det(M) M^-1
  double determinant_;     ///< |det M|
  double pixel_;           ///< rho / eta
  double p_;               ///< the prefilter's variance at the centre's depth, world units^2
  double flattened_;       ///< |adj(M) e_x|^2 + |adj(M) e_y|^2
};

}  // namespace surfcast::reference
