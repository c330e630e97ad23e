#include "kinds/ellipsoid_ray.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "kinds/ray_range.h"

namespace surfcast::kinds {
namespace {

constexpr double kFlattest = 1e-12;

/// The slopes s = x / z of all points in front of the eye's plane. The tangent ones are the roots of
/// (c_x - s c_z)^2 = |A_x - s A_z|^2; rows of A.
RayRange slopes(double cx, double cz, const glm::dvec3& ax, const glm::dvec3& az) {
  // Slopes t relative to the centre's: leading t^2 - 2 p t = |across|^2.
  const double leading = (cz - glm::length(az)) * (cz + glm::length(az));
  const glm::dvec3 across = ax - cx / cz * az;
  const double p = -glm::dot(across, az);
  const double root = std::sqrt(p * p + glm::dot(across, across) * leading);
  return {cx / cz + (p - root) / leading, cx / cz + (p + root) / leading};
}

}  // namespace

EllipsoidOnRays::EllipsoidOnRays(const glm::dvec3& centre, const glm::dmat3& axes, const glm::dvec3& semi_axes)
    : centre_(centre), axes_(axes), semi_axes_(glm::max(semi_axes, glm::dvec3(kFlattest * semi_axes.x))) {
  eye_ = -(centre_ * axes_) / semi_axes_;
}

std::optional<EllipsoidHit> EllipsoidOnRays::on_ray(const glm::dvec3& ray) const {
  if (glm::dot(eye_, eye_) <= 1) return std::nullopt;
  const glm::dvec3 direction = (ray * axes_) / semi_axes_;
  const double length = glm::length(direction);
  const glm::dvec3 unit = direction / length;
  const double along = -glm::dot(eye_, unit);
  const glm::dvec3 nearest = eye_ + along * unit;
  const double form = glm::dot(nearest, nearest);
  if (!(form <= 1) || !(along > 0)) return std::nullopt;
  const double before = std::sqrt((1 - std::sqrt(form)) * (1 + std::sqrt(form)));
  const double depth = (along - before) / length;
  if (!(depth > 0)) return std::nullopt;
  // The point in parameter space, divided by the semi-axes. The shortest of them keeps the quotients finite.
  const double shortest = std::min({semi_axes_.x, semi_axes_.y, semi_axes_.z});
  return EllipsoidHit{form, depth, glm::normalize(axes_ * ((nearest - before * unit) * (shortest / semi_axes_)))};
}

double EllipsoidOnRays::nearest_depth() const {
  const glm::dvec3 az(axes_[0].z, axes_[1].z, axes_[2].z);
  return centre_.z - glm::length(az * semi_axes_);
}

PixelRange EllipsoidOnRays::pixels(const geometry::CameraFrame& frame, const PixelRange& within) const {
  if (!(nearest_depth() > kBoundSlack * semi_axes_.x)) return within;
  const glm::dmat3 rows = glm::transpose(axes_);
  const RayRange x = slopes(centre_.x, centre_.z, rows[0] * semi_axes_, rows[2] * semi_axes_);
  const RayRange y = slopes(centre_.y, centre_.z, rows[1] * semi_axes_, rows[2] * semi_axes_);
  const glm::dvec2 low = frame.project({x.low, y.high, 1}) - 0.5 - kBoundSlack;
  const glm::dvec2 high = frame.project({x.high, y.low, 1}) - 0.5 + kBoundSlack;
  const auto bounded = [](double edge, int least, int most) {
    return static_cast<int>(std::clamp(edge, static_cast<double>(least), static_cast<double>(most)));
  };
  return {{bounded(std::ceil(low.x), within.first.x, within.last.x + 1),
           bounded(std::ceil(low.y), within.first.y, within.last.y + 1)},
          {bounded(std::floor(high.x), within.first.x - 1, within.last.x),
           bounded(std::floor(high.y), within.first.y - 1, within.last.y)}};
}

}  // namespace surfcast::kinds
