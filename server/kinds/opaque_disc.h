#pragma once

#include <glm/vec3.hpp>
#include <optional>

namespace surfcast::kinds {

/// The opaque disc of a surfel at the centre of a pixel that it covers (Ren 2002, section 5.1), computed as in the
/// visibility pass of the shaders, but in double precision. Symbols as in shaders/include/resampling_filter.glsl.
struct DiscHit {
  double form = 0;      ///< squared distance from the disc's centre, scaled to 1 at its rim
  double depth = 0;     ///< camera z of the surfel in this pixel
  double occluder = 0;  ///< camera z of the disc, pushed back: everything behind it is hidden
};

/// Intersects a surfel with centre `o` and unit normal `n` in the camera frame with the ray (x, y, 1) of a pixel. `eta`
/// is CameraFrame::eta. None if the surfel does not cover the pixel.
std::optional<DiscHit> hit_disc(const glm::dvec3& o, const glm::dvec3& n, double radius, const glm::dvec3& ray,
                                double eta);

/// The normal of the splat of scatter at `o` (camera frame): it faces the eye.
glm::dvec3 facing_eye(const glm::dvec3& o);

}  // namespace surfcast::kinds
