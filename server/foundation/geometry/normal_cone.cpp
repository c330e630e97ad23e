#include "geometry/normal_cone.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace surfcast::geometry {
namespace {

/// atan2 is accurate for small angles, acos is not.
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Rotates the unit vector `from` by `angle` radians towards `to`. The angle between them is `between`, in (0, pi).
glm::dvec3 turned(const glm::dvec3& from, const glm::dvec3& to, double angle, double between) {
  return glm::normalize((from * std::sin(between - angle) + to * std::sin(angle)) / std::sin(between));
}

}  // namespace

std::optional<NormalCone> normal_cone(std::span<const glm::vec3> normals) {
  glm::dvec3 sum{0};
  for (const glm::vec3& n : normals) sum += glm::dvec3(n);
  const double length = glm::length(sum);
  if (normals.empty() || length < 1e-6 * static_cast<double>(normals.size())) return std::nullopt;
  const glm::vec3 axis(sum / length);
  double widest = 0;
  for (const glm::vec3& n : normals) widest = std::max(widest, angle_between(glm::dvec3(axis), glm::dvec3(n)));
  const float rounded_up = std::nextafter(static_cast<float>(widest), 4.0f);
  return NormalCone{axis, std::min(rounded_up, std::numbers::pi_v<float>)};
}

std::optional<NormalCone> united(const NormalCone& a, const NormalCone& b) {
  const double between = angle_between(glm::dvec3(a.axis), glm::dvec3(b.axis));
  const double half_a{a.half_angle};
  const double half_b{b.half_angle};
  if (between + half_b <= half_a) return a;
  if (between + half_a <= half_b) return b;
  const double half = 0.5 * (half_a + between + half_b);
  if (half >= std::numbers::pi / 2) return std::nullopt;
  // The axis is rounded to single precision; the angle is widened by the rounding error.
  constexpr double kRounding = 1e-6;
  const glm::dvec3 axis = turned(glm::dvec3(a.axis), glm::dvec3(b.axis), half - half_a, between);
  return NormalCone{glm::vec3(axis), static_cast<float>(half + kRounding)};
}

}  // namespace surfcast::geometry
