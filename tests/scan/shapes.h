#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <random>
#include <vector>

namespace surfcast::testing {

/// `side` by `side` points in a plane of constant z.
inline std::vector<glm::dvec3> square_lattice(int side, double spacing, const glm::dvec3& corner) {
  std::vector<glm::dvec3> positions;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) positions.push_back(corner + spacing * glm::dvec3(x, y, 0));
  }
  return positions;
}

/// Points whose six nearest neighbours are all at `spacing`.
inline std::vector<glm::dvec3> hexagonal_lattice(int side, double spacing) {
  std::vector<glm::dvec3> positions;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      positions.push_back(spacing * glm::dvec3(x + 0.5 * (y % 2), y * std::numbers::sqrt3 / 2, 0));
    }
  }
  return positions;
}

/// Points spread evenly over a sphere (Fibonacci spiral).
inline std::vector<glm::dvec3> sphere(int count, const glm::dvec3& centre, double radius) {
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    positions.push_back(centre + radius * glm::dvec3(r * std::cos(angle), r * std::sin(angle), z));
  }
  return positions;
}

/// The surface of an axis-aligned box of that size around `centre`, on a lattice of that spacing.
inline std::vector<glm::dvec3> box_surface(const glm::dvec3& size, double spacing, const glm::dvec3& centre) {
  std::vector<glm::dvec3> positions;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (double a = spacing / 2; a < size[u]; a += spacing) {
      for (double b = spacing / 2; b < size[v]; b += spacing) {
        for (const double side : {-0.5, 0.5}) {
          glm::dvec3 p = centre;
          p[axis] += side * size[axis];
          p[u] += a - size[u] / 2;
          p[v] += b - size[v] / 2;
          positions.push_back(p);
        }
      }
    }
  }
  return positions;
}

/// Points anywhere in a cube: no surface at all.
inline std::vector<glm::dvec3> noise(int count, double size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(0, size);
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < count; ++i) {
    const double x = within(random);
    const double y = within(random);
    positions.emplace_back(x, y, within(random));
  }
  return positions;
}

}  // namespace surfcast::testing
