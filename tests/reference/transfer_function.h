#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

namespace surfcast::reference {

/// A point of a transfer function, as users state it.
struct TransferPoint {
  double value = 0;
  glm::dvec3 srgb{1};  ///< sRGB codes in [0, 1]
  double opacity = 0;  ///< of one grid spacing, in [0, 1]
};

/// What a scalar looks like.
struct Classified {
  glm::dvec3 color{0};    ///< linear light
  double extinction = 0;  ///< 1 / world unit
};

/// Colour and extinction over the scalar. Between points, the colour in linear light and the extinction are linear;
/// beyond the first and last they stay. Two points of one value are a step. Without points everything is clear.
class TransferFunction {
 public:
  TransferFunction() = default;
  /// Points in any order; of several at one value, the first and last count, in the order stated. `spacing`: the grid
  /// spacing to which opacities refer, world units.
  TransferFunction(std::vector<TransferPoint> points, double spacing);

  [[nodiscard]] Classified at(double value) const;
  /// The mean over the values between a and b; of colours, weighted by extinctions.
  [[nodiscard]] Classified mean(double a, double b) const;
  /// Whether any value in [low, high] has an opacity.
  [[nodiscard]] bool visible_within(double low, double high) const;

 private:
  struct Point {
    double value;
    Classified seen;
  };
  std::vector<Point> points_;
};

/// The light along a ray, composited front to back.
struct RayLight {
  glm::dvec3 light{0};
  double transmittance = 1;

  /// A stretch of one colour.
  void add(const glm::dvec3& color, double extinction, double length);
  /// A surface.
  void add_surface(const glm::dvec3& color, double coverage);
  [[nodiscard]] glm::dvec4 premultiplied() const { return {light, 1 - transmittance}; }
};

}  // namespace surfcast::reference
