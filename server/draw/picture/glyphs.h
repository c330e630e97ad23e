#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace surfcast::picture {

enum class GlyphShape { kEllipsoid, kSuperquadric };

/// What the semi-axes of a glyph are proportional to: the eigenvalues, their roots, or the eigenvalues divided by the
/// largest one.
enum class GlyphRadius { kEigenvalue, kRoot, kUnit };

/// Ellipsoids whose attribute is outside the range, or that have no such attribute, are not drawn.
struct Threshold {
  std::string attribute;  ///< "fa", "mode", "md", or a column of the file
  double smallest = 0;
  double largest = std::numeric_limits<double>::infinity();
  bool operator==(const Threshold&) const = default;
};

/// How the ellipsoids of tensor fields and tables are drawn.
struct GlyphOptions {
  GlyphShape shape = GlyphShape::kEllipsoid;
  GlyphRadius radius = GlyphRadius::kEigenvalue;
  std::optional<double> scale{};  ///< semi-axis of an eigenvalue, a root, or a ratio of 1, world units; none: the
                                  ///< source's own (model::EllipsoidSource)
  double sharpness = 3;           ///< of superquadrics: exponent of their roundness; 0: ellipsoids
  std::vector<Threshold> thresholds{};
};

/// A light from far away.
struct Light {
  glm::dvec3 direction{0, 0, -1};  ///< towards the light, in the camera frame: x right, y up, z forward; any length
  double power = 1;
  bool operator==(const Light&) const = default;
};

/// Light on surfaces: (ambient + sum power max(0, n.l)) colour + specular sum power max(0, n.h)^exponent, in linear
/// light, at most 1. h is half way between the light and the eye; only lights before the surface shine.
struct Lighting {
  double ambient = 0;
  double specular = 0;
  double exponent = 32;
  std::vector<Light> lights{};  ///< none: a headlight
};

}  // namespace surfcast::picture
