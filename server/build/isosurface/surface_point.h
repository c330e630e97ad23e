#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <optional>

#include "isosurface/sample_window.h"

namespace surfcast::isosurface {

/// A point of the surface on which the field has one value, in steps of the grid.
struct SurfacePoint {
  glm::dvec3 place{0};
  glm::dvec3 gradient{0};  ///< of the field; not zero
};

/// How far a point may be from its sample, along each axis, in steps of the grid.
inline constexpr int64_t kReach = 1;
/// The planes that the points of a plane depend on: so many before it, and behind it.
inline constexpr int64_t kPlanesBefore = kReach + 1;
inline constexpr int64_t kPlanesBehind = kReach + 2;

/// What is not less than the value is inside.
[[nodiscard]] constexpr bool is_inside(double sample, double value) {
  return sample >= value;
}

/// True if the surface passes between two samples that are numbers.
[[nodiscard]] constexpr bool is_between(double value, double a, double b) {
  return (a >= value && b < value) || (a < value && b >= value);
}

[[nodiscard]] inline double sample_at(const SampleWindow& samples, const Index& at) {
  return samples.row(at.y, at.z)[static_cast<size_t>(at.x)];
}

/// Calls `use` with each of the six neighbours of a sample that are on the other side of the surface.
template <typename Use>
void for_each_neighbour(const SampleWindow& samples, const Index& sample, double value, const Use& use) {
  const double own = sample_at(samples, sample);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int64_t step : {-1, 1}) {
      Index neighbour = sample;
      neighbour[axis] += step;
      if (neighbour[axis] < 0 || neighbour[axis] >= samples.size()[axis]) continue;
      if (is_between(value, own, sample_at(samples, neighbour))) use(neighbour);
    }
  }
}

/// Moves a sample that has a neighbour on the other side onto the surface: by Newton steps along the gradient, or along
/// the edge to a neighbour where these do not arrive. None where the field is flat or not a number.
[[nodiscard]] std::optional<SurfacePoint> move_to_surface(const SampleWindow& samples, const Index& sample,
                                                          double value);

}  // namespace surfcast::isosurface
