#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <numbers>
#include <string>
#include <vector>

namespace surfcast::testing {

/// A field over the world.
using Field = std::function<double(const glm::dvec3&)>;

/// Writes the samples of a field as an NRRD file.
inline std::filesystem::path write_grid(const std::filesystem::path& path, const Field& field,
                                        const std::array<int, 3>& size, const glm::dmat4x3& index_to_world) {
  std::filesystem::remove(path);
  std::ofstream file(path, std::ios::binary);
  file.precision(17);
  const auto vector = [&file](const glm::dvec3& v) { file << " (" << v.x << "," << v.y << "," << v.z << ")"; };
  file << "NRRD0004\ntype: double\ndimension: 3\nspace dimension: 3\nencoding: raw\nendian: little\nsizes: " << size[0]
       << " " << size[1] << " " << size[2] << "\nspace directions:";
  for (int axis = 0; axis < 3; ++axis) vector(index_to_world[axis]);
  file << "\nspace origin:";
  vector(index_to_world[3]);
  file << "\n\n";
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const double value = field(index_to_world * glm::dvec4(i, j, k, 1));
        file.write(reinterpret_cast<const char*>(&value), sizeof(value));
      }
    }
  }
  return path;
}

/// `count` samples along each axis of [-1, 1]^3.
inline glm::dmat4x3 unit_cube(int count) {
  const double step = 2.0 / (count - 1);
  return {{step, 0, 0}, {0, step, 0}, {0, 0, step}, {-1, -1, -1}};
}

/// A ball of radius 0.7 whose edge is about 0.06 wide.
inline double soft_ball(const glm::dvec3& p) {
  return 1 / (1 + std::exp((glm::length(p) - 0.7) / 0.06));
}

/// A tube around the circle of radius 0.6 in z = 0, Gaussian of deviation 0.15.
inline double torus(const glm::dvec3& p) {
  const double side = std::hypot(p.x, p.y) - 0.6;
  return std::exp(-(side * side + p.z * p.z) / (2 * 0.15 * 0.15));
}

/// Marschner and Lobb 1994: frequencies near the limit of 41 samples.
inline double marschner_lobb(const glm::dvec3& p) {
  constexpr double kPi = std::numbers::pi;
  const double wave = std::cos(2 * kPi * 6 * std::cos(kPi * std::hypot(p.x, p.y) / 2));
  return (1 - std::sin(kPi * p.z / 2) + 0.25 * (1 + wave)) / (2 * (1 + 0.25));
}

/// By central differences.
inline glm::dvec3 gradient_of(const Field& field, const glm::dvec3& p) {
  constexpr double kStep = 1e-5;
  glm::dvec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0);
    step[axis] = kStep;
    gradient[axis] = (field(p + step) - field(p - step)) / (2 * kStep);
  }
  return gradient;
}

/// The place of the true surface near `p`.
inline glm::dvec3 on_surface(const Field& field, double value, glm::dvec3 p) {
  for (int i = 0; i < 10; ++i) {
    const glm::dvec3 gradient = gradient_of(field, p);
    p -= gradient * ((field(p) - value) / glm::dot(gradient, gradient));
  }
  return p;
}

}  // namespace surfcast::testing
