#include "kinds/opaque_disc.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "kinds/ray_range.h"
#include "shared/kernel.h"

namespace surfcast::kinds {
namespace {

/// Radius that contains both the kernel and the disc of a surfel.
double extent_of(double radius) {
  return std::max(std::sqrt(SURFCAST_KERNEL_CUTOFF) * SURFCAST_KERNEL_SIGMA, SURFCAST_VISIBILITY_RADIUS) * radius;
}

/// v^T S^-1 v for S = s^2 J J^T + rho^2 I, as a sum of squares over the determinant, so nothing cancels at grazing
/// angles. s is the disc's radius in pixels if it faced the eye; rho is the prefilter of visibility.
double screen_form(const glm::dvec3& o, const glm::dvec3& n, double radius, const glm::dvec3& ray, double eta) {
  const glm::dvec2 v = eta * (glm::dvec2(ray) - glm::dvec2(o) / o.z);
  const glm::dvec3 mn = glm::cross(glm::dvec3(v.y, -v.x, ray.y * v.x - ray.x * v.y), n);
  const glm::dvec2 an = glm::dvec2(n) - glm::dvec2(ray) * n.z;
  const double trace = 2 + glm::dot(glm::dvec2(ray), glm::dvec2(ray)) - glm::dot(an, an);
  const double s2 = std::pow(SURFCAST_VISIBILITY_RADIUS * radius * eta / o.z, 2);
  const double rho2 = SURFCAST_VISIBILITY_PIXELS * SURFCAST_VISIBILITY_PIXELS;
  const double det = s2 * s2 * std::pow(glm::dot(n, ray), 2) + s2 * rho2 * trace + rho2 * rho2;
  return (s2 * glm::dot(mn, mn) + rho2 * glm::dot(v, v)) / det;
}

/// The x of all rays for which screen_form is at most 1; y likewise. A ray that is v pixels from the centre's, x0, is
/// in the ellipse of S = s^2 J J^T + rho^2 I only if v^2 <= S_xx. On a plane with the unit normal n, J J^T has the
/// diagonal element 1 + x^2 - (n_x - x n_z)^2 at the ray x = x0 + v / eta. So v lies between the roots of a quadratic,
/// whose leading coefficient is positive for discs in front of the eye plane. `ratio`: radius over depth.
RayRange ellipse_interval(double x0, double nx, double nz, double ratio, double eta) {
  const double s2 = std::pow(SURFCAST_VISIBILITY_RADIUS * ratio * eta, 2);
  const double rho2 = SURFCAST_VISIBILITY_PIXELS * SURFCAST_VISIBILITY_PIXELS;
  const double square = 1 - nz * nz;
  const double constant = rho2 + s2 * (1 - nx * nx + 2 * nx * nz * x0 + square * x0 * x0);
  const double linear = s2 * 2 * (nx * nz + square * x0) / eta;
  const double leading = 1 - s2 * square / (eta * eta);
  const double middle = linear / (2 * leading);
  const double half = std::sqrt(std::max(0.0, middle * middle + constant / leading)) * (1 + kBoundSlack) + kBoundSlack;
  return {x0 + (middle - half) / eta, x0 + (middle + half) / eta};
}

/// The x of all rays that meet a ball in front of the eye plane.
RayRange ball_interval(double x, double z, double radius) {
  return {std::min((x - radius) / (z - radius), (x - radius) / (z + radius)),
          std::max((x + radius) / (z - radius), (x + radius) / (z + radius))};
}

/// The pixels of a rectangle whose rays lie in both intervals. None if there are none.
std::optional<PixelRange> pixels_between(const RayRange& x, const RayRange& y, const geometry::CameraFrame& frame,
                                         const PixelRange& within) {
  const auto first = [](double edge, int least, int most) {
    return static_cast<int>(std::clamp(std::ceil(edge - 0.5 - kBoundSlack), double(least), most + 1.0));
  };
  const auto last = [](double edge, int least, int most) {
    return static_cast<int>(std::clamp(std::floor(edge - 0.5 + kBoundSlack), least - 1.0, double(most)));
  };
  const glm::dvec2 low = frame.project({x.low, y.high, 1});
  const glm::dvec2 high = frame.project({x.high, y.low, 1});
  const PixelRange range{{first(low.x, within.first.x, within.last.x), first(low.y, within.first.y, within.last.y)},
                         {last(high.x, within.first.x, within.last.x), last(high.y, within.first.y, within.last.y)}};
  return range.empty() ? std::nullopt : std::optional(range);
}

}  // namespace

std::optional<DiscHit> hit_disc(const glm::dvec3& o, const glm::dvec3& n, double radius, const glm::dvec3& ray,
                                double eta) {
  const double extent = extent_of(radius);
  if (o.z + 2 * radius <= 0) return std::nullopt;
  const double meeting = glm::dot(n, o) / glm::dot(n, ray);
  const double plane = meeting > 0 ? meeting : std::numeric_limits<double>::infinity();
  const double push = SURFCAST_VISIBILITY_DEPTH * radius + SURFCAST_VISIBILITY_FOOTPRINT * std::max(o.z, 0.0) / eta;
  if (o.z <= 1.5 * extent) {
    // The disc may reach the eye plane, where projection is undefined, so the distance is measured on the surface.
    if (!std::isfinite(plane)) return std::nullopt;
    const glm::dvec3 u = (plane * ray - o) / (SURFCAST_VISIBILITY_RADIUS * radius);
    const double form = glm::dot(u, u);
    return form <= 1 ? std::optional(DiscHit{form, plane, plane + push, plane}) : std::nullopt;
  }
  const double form = screen_form(o, n, radius, ray, eta);
  if (!(form <= 1)) return std::nullopt;
  const double range = extent * std::sqrt(std::max(0.0, 1 - n.z * n.z));
  const double depth = std::min(plane, o.z + range);
  // Footprints of depth a pixel.
  const double slope = std::min(std::hypot(n.x, n.y) * o.z / std::abs(glm::dot(n, o)), SURFCAST_VISIBILITY_SLOPE);
  const double occluder = std::max(plane, o.z - range) * (1 + push / o.z + SURFCAST_VISIBILITY_PIXELS * slope / eta);
  return DiscHit{form, depth, occluder, std::max(depth, o.z - range)};
}

std::optional<DiscHit> hit_surface(const surfel::OsculatingSurface& surface, double radius,
                                   const std::optional<surfel::Border>& border, const glm::dvec3& ray, double eta,
                                   bool oriented) {
  const std::optional<surfel::SurfaceHit> hit = surfel::meet(surface, ray, oriented);
  if (!hit) return std::nullopt;
  const double disc = SURFCAST_VISIBILITY_RADIUS * radius;
  const double form = glm::dot(hit->place, hit->place) / (disc * disc);
  if (!(form <= 1)) return std::nullopt;
  if (border && glm::dot(hit->place, border->direction) > border->distance * radius) return std::nullopt;
  const double push = SURFCAST_VISIBILITY_DEPTH * radius + SURFCAST_VISIBILITY_FOOTPRINT * hit->t / eta;
  return DiscHit{form, hit->t, hit->t + push, hit->t};
}

double ball_of(const surfel::OsculatingSurface& surface, double radius) {
  const double extent = extent_of(radius);
  return std::hypot(extent, 0.5 * surface.curvature.largest() * extent * extent);
}

std::optional<PixelRange> ball_pixels(const glm::dvec3& o, double radius, const geometry::CameraFrame& frame,
                                      const PixelRange& within) {
  if (o.z + radius <= 0) return std::nullopt;
  const double reach = radius * (1 + kBoundSlack);
  if (o.z <= reach) return within;
  return pixels_between(ball_interval(o.x, o.z, reach), ball_interval(o.y, o.z, reach), frame, within);
}

double nearest_depth(const glm::dvec3& o, double radius) {
  return o.z - extent_of(radius);
}

std::optional<PixelRange> disc_pixels(const glm::dvec3& o, const glm::dvec3& n, double radius,
                                      const geometry::CameraFrame& frame, const PixelRange& within) {
  if (o.z + 2 * radius <= 0) return std::nullopt;
  if (o.z > 1.5 * extent_of(radius)) {
    const RayRange x = ellipse_interval(o.x / o.z, n.x, n.z, radius / o.z, frame.eta);
    const RayRange y = ellipse_interval(o.y / o.z, n.y, n.z, radius / o.z, frame.eta);
    return pixels_between(x, y, frame, within);
  }
  return ball_pixels(o, radius, frame, within);
}

glm::dvec3 facing_eye(const glm::dvec3& o) {
  const double distance = glm::length(o);
  return distance > 0 ? -o / distance : glm::dvec3(0, 0, -1);
}

}  // namespace surfcast::kinds
