#include "kinds/opaque_disc.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

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
    return form <= 1 ? std::optional(DiscHit{form, plane, plane + push}) : std::nullopt;
  }
  const double form = screen_form(o, n, radius, ray, eta);
  if (!(form <= 1)) return std::nullopt;
  const double range = extent * std::sqrt(std::max(0.0, 1 - n.z * n.z));
  return DiscHit{form, std::min(plane, o.z + range), std::max(plane, o.z - range) * (1 + push / o.z)};
}

glm::dvec3 facing_eye(const glm::dvec3& o) {
  const double distance = glm::length(o);
  return distance > 0 ? -o / distance : glm::dvec3(0, 0, -1);
}

}  // namespace surfcast::kinds
