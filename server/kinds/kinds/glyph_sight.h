#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace surfcast::kinds {

/// What the semi-axes of a glyph are proportional to, see picture::GlyphRadius.
enum class GlyphMeasure { kEigenvalue, kRoot, kUnit };

/// What a picture shows of a source of ellipsoids.
struct GlyphSight {
  /// Shown are ellipsoids whose attribute is in the range; `attribute` is an index into EllipsoidSource::attributes,
  /// or -1 if the source lacks it: none is shown.
  struct Range {
    int attribute = -1;
    double smallest = 0;
    double largest = 0;
  };
  /// Shown are ellipsoids whose centre c is in a layer: |dot(normal, c - point)| <= 1/2.
  struct Layer {
    glm::dvec3 point{0};
    glm::dvec3 normal{0};
  };

  double scale = 1;  ///< semi-axis of a value (or a root, or a ratio) of 1, world units
  GlyphMeasure measure = GlyphMeasure::kEigenvalue;
  std::vector<Range> ranges;  ///< all hold
  std::vector<Layer> layers;  ///< one of them holds; none: no limit

  /// Semi-axes of values, world units.
  [[nodiscard]] glm::dvec3 semi_axes(const glm::dvec3& values) const;
};

}  // namespace surfcast::kinds
