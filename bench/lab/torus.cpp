#include "lab/torus.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace surfcast::lab {
namespace {

using reference::SurfacePoint;

constexpr double kTurn = 2 * std::numbers::pi;

double distance_to(const Torus& torus, const glm::dvec3& p) {
  return std::hypot(std::hypot(p.x, p.y) - torus.ring, p.z) - torus.tube;
}

SurfacePoint nearest_point(const Torus& torus, const glm::dvec3& p) {
  const double u = std::atan2(p.y, p.x) / kTurn + 0.5;
  const double v = std::atan2(p.z, std::hypot(p.x, p.y) - torus.ring) / kTurn + 0.5;
  return torus_point(torus, u, v);
}

}  // namespace

SurfacePoint torus_point(const Torus& torus, double u, double v) {
  const double a = (u - 0.5) * kTurn;
  const double b = (v - 0.5) * kTurn;
  const glm::dvec3 outwards{std::cos(a), std::sin(a), 0};
  const glm::dvec3 n = std::cos(b) * outwards + glm::dvec3(0, 0, std::sin(b));
  return {torus.ring * outwards + torus.tube * n, n, {u, v}};
}

reference::RaySurface ray_surface(const Torus& torus) {
  return [torus](const glm::dvec3& origin, const glm::dvec3& direction) -> std::optional<SurfacePoint> {
    // Sphere tracing: steps of the distance to the surface, from the ray's entry into the bounding sphere.
    constexpr double kNear = 1e-7;
    constexpr int kSteps = 200;
    const double ball = torus.ring + torus.tube;
    const glm::dvec3 d = glm::normalize(direction);
    const double middle = -glm::dot(origin, d);
    const double half = ball * ball - glm::dot(origin + middle * d, origin + middle * d);
    if (half <= 0 || middle + std::sqrt(half) <= 0) return std::nullopt;
    double t = std::max(middle - std::sqrt(half), 0.0);
    const double end = middle + std::sqrt(half);
    for (int i = 0; i < kSteps && t <= end; ++i) {
      const double step = distance_to(torus, origin + t * d);
      if (step < kNear) return nearest_point(torus, origin + t * d);
      t += step;
    }
    return std::nullopt;
  };
}

std::vector<SurfacePoint> uneven_samples(const Torus& torus, int around, int along, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(0, 1);
  std::vector<SurfacePoint> points;
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double u = (i + offset(random)) / around;
      const double v = (j + offset(random)) / along;
      points.push_back(torus_point(torus, u, v));
    }
  }
  return points;
}

}  // namespace surfcast::lab
