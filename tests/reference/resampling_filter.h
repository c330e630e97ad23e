#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "geometry/camera.h"
#include "shared/kernel.h"

namespace surfcast::reference {

/// The constants of shaders/shared/kernel.h as variables, so that a study can change them.
struct KernelParameters {
  double sigma = SURFCAST_KERNEL_SIGMA;
  double cutoff_minified = SURFCAST_KERNEL_CUTOFF_MINIFIED;
  double cutoff_magnified = SURFCAST_KERNEL_CUTOFF;
  double visibility_radius = SURFCAST_VISIBILITY_RADIUS;
  double visibility_pixels = SURFCAST_VISIBILITY_PIXELS;
  double visibility_depth = SURFCAST_VISIBILITY_DEPTH;
  double visibility_footprint = SURFCAST_VISIBILITY_FOOTPRINT;
  double visibility_slope = SURFCAST_VISIBILITY_SLOPE;
  double coverage_minified = SURFCAST_COVERAGE_MINIFIED;
  double coverage_magnified = SURFCAST_COVERAGE_MAGNIFIED;
  double scatter_minified = SURFCAST_SCATTER_MINIFIED;
  double scatter_power = SURFCAST_SCATTER_POWER;
  double silhouette_variance = SURFCAST_SILHOUETTE_VARIANCE;
  double silhouette_coverage = SURFCAST_SILHOUETTE_COVERAGE;
  double silhouette_jump = SURFCAST_SILHOUETTE_JUMP;
  int silhouette_reach = SURFCAST_SILHOUETTE_REACH;
};

/// The contribution of a surfel to one pixel, before its weight.
struct Fragment {
  double r2 = 0;    ///< squared Mahalanobis distance of the pixel in the resampling filter
  double gain = 0;  ///< peak of the prefiltered kernel relative to the kernel's peak, in [0, 1]
};

/// The splat of one surfel in one camera: the object space EWA filter (Ren 2002, section 4), exact in perspective.
///
/// Symbols: o centre, n unit normal, both in the camera frame; d = (x, y, 1) a pixel's ray; v = eta (d.xy - o.xy / o.z)
/// the pixel's displacement from the projected centre, pixels, y up; s = sigma eta / o.z the kernel's standard
/// deviation in pixels for a front-facing surfel; rho the prefilter's standard deviation, pixels.
class Splat {
 public:
  /// None if the surfel is invisible in every pixel: behind the eye, or degenerate.
  static std::optional<Splat> make(const glm::dvec3& o, const glm::dvec3& n, double radius, double eta,
                                   double prefilter, const KernelParameters& kernel);

  [[nodiscard]] Fragment fragment(const glm::dvec3& d) const;
  /// The gain of a fragment with another prefilter; `prefilter` is its standard deviation in pixels.
  [[nodiscard]] double gain(const glm::dvec3& d, double prefilter) const;
  [[nodiscard]] bool cut(double r2) const { return !(r2 <= cutoff_); }
  /// Value of the kernel: exp(-r2 / 2), lowered by a constant so that a magnified kernel is 0 at its cutoff.
  [[nodiscard]] double kernel(double r2) const { return std::exp(-0.5 * r2) - rim_; }
  /// Whether the surfel's opaque disc covers the pixel.
  [[nodiscard]] bool opaque(const glm::dvec3& d) const;
  /// Depth (camera z) for the depth test of a fragment: that of the surfel's plane along the ray, but at most that of
  /// the splat's far end. Without this limit, a prefilter wider than the splat would use the plane far beyond the
  /// splat.
  [[nodiscard]] double fragment_depth(const glm::dvec3& d) const;
  /// Depth of the opaque disc: that of the plane, but at least that of the splat's near end, then pushed back along the
  /// ray (Ren 2002, section 5.1). Coplanar fragments are never behind the pushed depth, at any slope.
  struct DiscDepth {
    double unpushed;
    double pushed;
  };
  [[nodiscard]] DiscDepth disc_depth(const glm::dvec3& d) const;

  /// Bounds of d.xy over every pixel that the splat or its disc can touch.
  struct Bounds {
    glm::dvec2 min;
    glm::dvec2 max;
  };
  [[nodiscard]] Bounds bounds() const;

 private:
  [[nodiscard]] double plane_depth(const glm::dvec3& d) const;
  [[nodiscard]] Fragment quadratic(const glm::dvec3& d, double s, double rho) const;
  [[nodiscard]] Fragment object_space(const glm::dvec3& d, double deviation) const;

  glm::dvec3 o_{0};
  glm::dvec3 n_{0};
  double eta_ = 0;
  double scale_ = 0;      ///< pixels per world unit at the centre's depth
  glm::dvec2 centre_{0};  ///< d.xy of the projected centre
  double sigma_ = 0;
  double prefilter_ = 0;
  double cutoff_ = 0;
  double rim_ = 0;
  double extent_ = 0;       ///< radius of the splat in the tangent plane, world units
  double depth_range_ = 0;  ///< largest difference in depth between the splat's rim and its centre, camera z
  double disc_radius_ = 0;
  double disc_pixels_ = 0;
  double push_ = 0;  ///< of the opaque disc along the ray, at the centre's depth, camera z

  bool reaches_eye_plane_ = false;  ///< the disc reaches the eye's plane, where the projection is undefined
};

}  // namespace surfcast::reference
