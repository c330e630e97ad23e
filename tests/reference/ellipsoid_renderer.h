#pragma once

#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "reference/light_picture.h"

namespace surfcast::reference {

/// An opaque ellipsoid.
struct EllipsoidGlyph {
  glm::dvec3 centre{0};   ///< world
  glm::dvec3 values{1};   ///< semi-axes, descending
  glm::dquat rotation{};  ///< unit; the columns of its matrix are the axes
  glm::dvec3 color{0.8};  ///< linear light
  /// Exponent of the roundness of a superquadric (Kindlmann 2004); none: an ellipsoid.
  std::optional<double> sharpness{};
};

/// Where a ray from the eye meets an ellipsoid first.
struct EllipsoidHit {
  double depth = 0;      ///< along the camera's z; the ray's direction has z = 1
  glm::dvec3 normal{0};  ///< unit, camera frame
};

/// A glyph in the camera frame, ready for rays. Everything is in double precision: the ray in the frame where the
/// ellipsoid is the unit sphere, from its place nearest to the centre.
class RayEllipsoid {
 public:
  RayEllipsoid(const EllipsoidGlyph& glyph, const geometry::CameraFrame& frame);
  /// The eye is inside: the ellipsoid is not drawn.
  [[nodiscard]] bool around_eye() const;
  /// `d`: camera frame, z = 1. Only what is ahead of the eye.
  [[nodiscard]] std::optional<EllipsoidHit> hit(const glm::dvec3& d) const;
  /// Square of the distance of the ray from the centre, in the frame where the ellipsoid is the unit sphere.
  [[nodiscard]] double distance_squared(const glm::dvec3& d) const;
  /// The rectangle of pixels in which it may be seen: low x, low y, high x, high y. None behind the eye.
  [[nodiscard]] std::optional<glm::dvec4> bounds(const geometry::CameraFrame& frame) const;

 private:
  [[nodiscard]] std::optional<EllipsoidHit> superquadric_hit(const glm::dvec3& d) const;
  /// Above 0 outside of the superquadric, in the frame of the unit sphere.
  [[nodiscard]] double outside(const glm::dvec3& p) const;

  glm::dmat3 axes_{1};  ///< camera frame
  glm::dvec3 semi_{1};
  glm::dvec3 centre_{0};         ///< camera frame
  glm::dvec3 eye_{0};            ///< in the frame of the unit sphere
  std::optional<glm::dvec2> e_;  ///< exponents of a superquadric about its axis and along it
  bool along_first_ = false;     ///< that axis is the first one, otherwise the last one
};

/// Linear light of a colour at a hit; `n` unit, `d` with z = 1, camera frame.
using GlyphLight = std::function<glm::dvec3(const glm::dvec3& color, const glm::dvec3& n, const glm::dvec3& d)>;
/// 0.1 + 0.9 |n.d| / |d|.
glm::dvec3 glyph_headlight(const glm::dvec3& color, const glm::dvec3& n, const glm::dvec3& d);

/// The nearest hits of `samples` x `samples` rays a pixel under the pixel prefilter.
LightPicture ellipsoid_picture(std::span<const EllipsoidGlyph> glyphs, const geometry::CameraFrame& frame, int samples,
                               const GlyphLight& light = glyph_headlight);

/// Glyphs, and a camera for them.
struct EllipsoidScene {
  std::vector<EllipsoidGlyph> glyphs;
  geometry::Camera camera;
  int side = 512;  ///< pixels of its picture
};
/// "helix", "mixed", "needles", "extreme", "overlap", "close" or "far".
EllipsoidScene make_ellipsoid_scene(const std::string& name);
/// sRGB (1 - w) / 2 + w |v1| with w = (l1 - l2) / l1, as linear light.
glm::dvec3 direction_color(const EllipsoidGlyph& glyph);

}  // namespace surfcast::reference
