#include "reference/volume_ray_caster.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "reference/headlight.h"

namespace surfcast::reference {
namespace {

constexpr double kClear = 1e-6;  ///< transmittance at which a ray ends
constexpr double kStepPerSpacing = 0.5;

/// The part of the ray within low and high along every axis.
RayInterval clipped(RayInterval part, const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& low,
                    const glm::dvec3& high) {
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) {
      if (origin[i] < low[i] || origin[i] > high[i]) part.end = part.begin;
      continue;
    }
    const double a = (low[i] - origin[i]) / direction[i];
    const double b = (high[i] - origin[i]) / direction[i];
    part.begin = std::max(part.begin, std::min(a, b));
    part.end = std::min(part.end, std::max(a, b));
  }
  return part;
}

/// A grid whose values are one coordinate of the gradients.
VolumeGrid coordinate(const VolumeGrid& grid, const std::vector<glm::dvec3>& gradients, int axis) {
  VolumeGrid result = grid;
  std::transform(gradients.begin(), gradients.end(), result.values.begin(), [&](const auto& g) { return g[axis]; });
  return result;
}

double smallest_spacing(const VolumeGrid& grid) {
  return std::min({glm::length(grid.axes[0]), glm::length(grid.axes[1]), glm::length(grid.axes[2])});
}

}  // namespace

RayInterval visible_interval(const VolumeGrid& grid, const std::optional<ClipBox>& clip, const glm::dvec3& eye,
                             const glm::dvec3& direction) {
  const glm::dmat3 to_index = glm::inverse(grid.axes);
  const double everything = 1e300;
  RayInterval part =
      clipped({0, everything}, to_index * (eye - grid.origin), to_index * direction, grid.low, grid.high);
  if (clip) part = clipped(part, eye, direction, clip->low, clip->high);
  return part;
}

glm::dvec3 ray_direction(const geometry::CameraFrame& frame, const glm::dvec2& pixel) {
  const glm::dvec3 d = frame.ray(pixel);
  return glm::normalize(frame.right * d.x + frame.up * d.y + frame.forward * d.z);
}

glm::dvec4 cast_ray(const RayMedium& medium, const TransferFunction& transfer, const glm::dvec3& eye,
                    const glm::dvec3& direction, const RayInterval& interval, double step) {
  RayLight ray;
  if (!(interval.end > interval.begin)) return ray.premultiplied();
  const int steps = static_cast<int>(std::ceil((interval.end - interval.begin) / step));
  const double length = (interval.end - interval.begin) / steps;
  for (int i = 0; i < steps && ray.transmittance > kClear; ++i) {
    const glm::dvec3 place = eye + (interval.begin + (i + 0.5) * length) * direction;
    const Classified seen = transfer.at(medium.scalar(place));
    if (seen.extinction == 0) continue;
    const double shade = medium.gradient ? headlight(medium.gradient(place), direction) : 1;
    ray.add(shade * seen.color, seen.extinction, length);
  }
  return ray.premultiplied();
}

LightPicture ray_cast(const VolumeGrid& grid, const TransferFunction& transfer, bool shaded,
                      const geometry::CameraFrame& frame, Reconstruction reconstruction) {
  const auto interpolate = reconstruction == Reconstruction::kTrilinear ? trilinear : catmull_rom;
  const glm::dmat3 to_index = glm::inverse(grid.axes);
  const auto index = [&](const glm::dvec3& place) { return to_index * (place - grid.origin); };
  RayMedium medium{[&](const glm::dvec3& place) { return interpolate(grid, index(place)); }, {}};
  std::vector<VolumeGrid> slopes;
  if (shaded) {
    const std::vector<glm::dvec3> gradients = sample_gradients(grid);
    for (int axis = 0; axis < 3; ++axis) slopes.push_back(coordinate(grid, gradients, axis));
    medium.gradient = [&](const glm::dvec3& place) {
      const glm::dvec3 i = index(place);
      return glm::dvec3(interpolate(slopes[0], i), interpolate(slopes[1], i), interpolate(slopes[2], i));
    };
  }
  const double step = kStepPerSpacing * smallest_spacing(grid);
  return sampled_picture(frame.width, frame.height, [&](const glm::dvec2& pixel) {
    const glm::dvec3 direction = ray_direction(frame, pixel);
    const RayInterval part = visible_interval(grid, {}, frame.eye, direction);
    return cast_ray(medium, transfer, frame.eye, direction, part, step);
  });
}

}  // namespace surfcast::reference
