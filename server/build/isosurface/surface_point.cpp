#include "isosurface/surface_point.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "isosurface/field.h"

namespace surfcast::isosurface {
namespace {

/// Newton steps until one is this short, in steps of the grid. The next one would be shorter than the errors of the
/// field.
constexpr double kClose = 0.02;
/// Smooth fields take two; near a hard edge, where the field overshoots, three or four arrive.
constexpr int kMaxSteps = 5;
/// Halvings of an edge: to the precision of a double near 1000.
constexpr int kHalvings = 40;

/// From `place` to where the field has the value if it is linear. On a face of the grid, whose last sample is at
/// `last`, along the face. Not a number where the field is flat.
glm::dvec3 newton_step(const FieldValue& field, double value, const glm::dvec3& place, const glm::dvec3& last) {
  const double lack = value - field.value;
  glm::dvec3 along = field.gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const double motion = lack * along[axis];
    if ((motion < 0 && place[axis] <= 0) || (motion > 0 && place[axis] >= last[axis])) along[axis] = 0;
  }
  return along * (lack / glm::dot(along, along));
}

bool has_direction(const glm::dvec3& gradient) {
  const double square = glm::dot(gradient, gradient);
  return square > 0 && std::isfinite(square);
}

std::optional<SurfacePoint> follow_gradient(const SampleWindow& samples, const Index& sample, double value) {
  const glm::dvec3 start(sample);
  const glm::dvec3 last(samples.size() - int64_t{1});
  const glm::dvec3 lowest = glm::max(start - static_cast<double>(kReach), glm::dvec3(0));
  const glm::dvec3 highest = glm::min(start + static_cast<double>(kReach), last);
  glm::dvec3 place = start;
  for (int taken = 0; taken < kMaxSteps; ++taken) {
    const FieldValue field = field_at(samples, place);
    const glm::dvec3 step = newton_step(field, value, place, last);
    const double length = glm::length(step);
    if (!std::isfinite(length)) return std::nullopt;
    place = glm::clamp(place + step / std::max(length, 1.0), lowest, highest);
    if (length <= kClose) return SurfacePoint{place, field.gradient};
  }
  return std::nullopt;
}

/// The point between two places on either side of the surface.
SurfacePoint halve_edge(const SampleWindow& samples, glm::dvec3 inside, glm::dvec3 outside, double value) {
  FieldValue field;
  for (int i = 0; i < kHalvings; ++i) {
    const glm::dvec3 middle = 0.5 * (inside + outside);
    field = field_at(samples, middle);
    (field.value >= value ? inside : outside) = middle;
  }
  return {0.5 * (inside + outside), field.gradient};
}

/// The nearest point on the edges to neighbours on the other side. The field goes through the samples, so there is one.
std::optional<SurfacePoint> search_edges(const SampleWindow& samples, const Index& sample, double value) {
  std::optional<SurfacePoint> nearest;
  double least = INFINITY;
  const bool inside = is_inside(sample_at(samples, sample), value);
  for_each_neighbour(samples, sample, value, [&](const Index& neighbour) {
    const glm::dvec3 a(inside ? sample : neighbour);
    const glm::dvec3 b(inside ? neighbour : sample);
    const SurfacePoint point = halve_edge(samples, a, b, value);
    const double distance = glm::distance(point.place, glm::dvec3(sample));
    if (distance >= least || !has_direction(point.gradient)) return;
    least = distance;
    nearest = point;
  });
  return nearest;
}

}  // namespace

std::optional<SurfacePoint> move_to_surface(const SampleWindow& samples, const Index& sample, double value) {
  const std::optional<SurfacePoint> point = follow_gradient(samples, sample, value);
  return point && has_direction(point->gradient) ? point : search_edges(samples, sample, value);
}

}  // namespace surfcast::isosurface
