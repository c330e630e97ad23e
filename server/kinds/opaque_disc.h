#pragma once

#include <glm/vec3.hpp>
#include <optional>

namespace surfcast::kinds {

/// The opaque disc of a surfel where it covers the centre of a pixel (Ren 2002, section 5.1), as the visibility pass of
/// the shaders has it, in double precision. Symbols are those of shaders/include/resampling_filter.glsl.
struct DiscHit {
  double form = 0;      ///< squared distance from the disc's centre, 1 at its rim
  double depth = 0;     ///< camera z at which the surfel is seen
  double occluder = 0;  ///< camera z of the disc, pushed back: what is seen behind it is hidden
};

/// A surfel with centre `o` and unit normal `n` in the camera frame, under the ray (x, y, 1) of a pixel; `eta` is
/// CameraFrame::eta. None where it does not cover the pixel.
std::optional<DiscHit> hit_disc(const glm::dvec3& o, const glm::dvec3& n, double radius, const glm::dvec3& ray,
                                double eta);

}  // namespace surfcast::kinds
