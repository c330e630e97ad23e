#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "geometry/camera.h"
#include "kinds/pixel_hits.h"

namespace surfcast::kinds {

/// A Gaussian in the camera frame, as rays see it: exact in perspective (docs/kernel.md).
class GaussianOnRays {
 public:
  /// `factor`: its columns are the axes times the deviations; flat ones have a column of 0.
  GaussianOnRays(const glm::dvec3& centre, const glm::dmat3& factor, double opacity, double eta);

  struct Seen {
    double r2 = 0;     ///< squared distance from the centre in deviations, on the screen
    double depth = 0;  ///< camera z of the densest place on the ray
    double opacity = 0;
  };
  /// None where the ray, which has z = 1, meets less than 1/255 of it, or it lies behind the eye.
  [[nodiscard]] std::optional<Seen> on_ray(const glm::dvec3& ray) const;
  /// The pixels of `within` that may see it.
  [[nodiscard]] PixelRange pixels(const geometry::CameraFrame& frame, const PixelRange& within) const;

 private:
  glm::dvec3 o_;
  glm::dmat3 transposed_;
  glm::dmat3 adjugate_;
  double opacity_;
  double cutoff_;    ///< largest r2 that is seen
  double variance_;  ///< of the prefilter at the centre's depth, world units squared
};

}  // namespace surfcast::kinds
