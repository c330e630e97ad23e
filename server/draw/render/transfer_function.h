#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "picture/transfer.h"

namespace surfcast::render {

/// What a value looks like.
struct Classified {
  glm::dvec3 color{0};    ///< linear light
  double extinction = 0;  ///< 1 / world unit
};

/// Sums over bins of the value. Bin 0 is everything below the first point, the last bin everything above the last one,
/// SURFCAST_TRANSFER_BINS bins are between them. Integers, because differences of sums must be exact.
struct TransferTable {
  /// For each bin the sums over the bins before it: colour times extinction, extinction; then the sum of all.
  std::vector<glm::uvec4> sums;
  double first = 0;            ///< value where bin 1 begins
  double bins_per_value = 1;   ///< bin 1 + bins_per_value * (value - first)
  double extinction_unit = 0;  ///< 1 / world unit, of one unit of the sums
  double color_unit = 0;
};

/// Linear light of an sRGB colour, components from 0 to 1.
glm::dvec3 linear_from_srgb(const glm::dvec3& color);

/// The points in ascending order of their values; those of one value as they were.
std::vector<picture::TransferPoint> sorted_points(std::span<const picture::TransferPoint> points);

/// Colour and extinction over the values of one volume, both linear between points. Opacities refer to a grid spacing:
/// the extinction is -ln(1 - opacity) / spacing, at most 16 / spacing, so that the opacity 1 stays finite. A stated
/// extinction is at most 256 / spacing, so that sums keep their digits where little is seen.
class TransferFunction {
 public:
  /// `spacing`: world units, above 0. `opacity`: from 0 to 1, factor of the opacities of one spacing.
  TransferFunction(std::span<const picture::TransferPoint> points, double spacing, double opacity = 1);

  [[nodiscard]] Classified at(double value) const;
  /// True if any value in [low, high] has an opacity. Exact.
  [[nodiscard]] bool visible_within(double low, double high) const;
  [[nodiscard]] TransferTable table() const;

 private:
  struct Point {
    double value;
    Classified seen;
  };
  /// Integral over the values from `low` to `high`, between which no point lies.
  [[nodiscard]] glm::dvec4 smooth_integral(double low, double high) const;
  [[nodiscard]] glm::dvec4 integral(double low, double high) const;

  std::vector<Point> points_;
};

}  // namespace surfcast::render
