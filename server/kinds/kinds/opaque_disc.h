#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "geometry/camera.h"
#include "kinds/pixel_hits.h"
#include "surfel/curvature.h"

namespace surfcast::kinds {

/// The opaque disc of a surfel at the centre of a pixel that it covers (Ren 2002, section 5.1), computed as in the
/// visibility pass of the shaders, but in double precision. Symbols as in shaders/include/resampling_filter.glsl.
struct DiscHit {
  double form = 0;      ///< squared distance from the disc's centre, scaled to 1 at its rim
  double depth = 0;     ///< camera z of the surfel in this pixel
  double occluder = 0;  ///< camera z of the disc, pushed back: everything behind it is hidden
  /// Camera z of the disc in this pixel: `depth`, but not nearer than the disc. The prefilter widens discs on the
  /// screen, and the plane of a disc that is seen edge-on comes close to the eye beside it.
  double surface = 0;
};

/// Intersects a surfel with centre `o` and unit normal `n` in the camera frame with the ray (x, y, 1) of a pixel. `eta`
/// is CameraFrame::eta. None if the surfel does not cover the pixel.
std::optional<DiscHit> hit_disc(const glm::dvec3& o, const glm::dvec3& n, double radius, const glm::dvec3& ray,
                                double eta);

/// The same for a surfel with curvature, in the camera frame: as in shaders/curved/fragment.glsl.
std::optional<DiscHit> hit_surface(const surfel::OsculatingSurface& surface, double radius,
                                   const std::optional<surfel::Border>& border, const glm::dvec3& ray, double eta,
                                   bool oriented);
/// Radius of a ball about the centre that contains the part of the surface that is drawn.
double ball_of(const surfel::OsculatingSurface& surface, double radius);
/// The pixels within `within` where a ball is seen. None if it is seen in no pixel.
std::optional<PixelRange> ball_pixels(const glm::dvec3& o, double radius, const geometry::CameraFrame& frame,
                                      const PixelRange& within);

/// The normal of the splat of scatter at `o` (camera frame): it faces the eye.
glm::dvec3 facing_eye(const glm::dvec3& o);

/// A lower bound of DiscHit::surface in all pixels.
double nearest_depth(const glm::dvec3& o, double radius);

/// The pixels within `within` where hit_disc may find the surfel. None if it finds it in no pixel.
std::optional<PixelRange> disc_pixels(const glm::dvec3& o, const glm::dvec3& n, double radius,
                                      const geometry::CameraFrame& frame, const PixelRange& within);

}  // namespace surfcast::kinds
