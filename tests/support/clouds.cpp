#include "support/clouds.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "shared/kernel.h"
#include "surfel/even_sampling.h"

namespace surfcast::testing {
namespace {

float even_weight() {
  return static_cast<float>(std::min(1.0, surfel::even_sampling_weight(SURFCAST_KERNEL_SIGMA)));
}

void add(surfel::SurfelCloud& cloud, const glm::dvec3& position, const glm::dvec3& normal, double radius,
         const glm::u8vec3& color) {
  cloud.positions.push_back(position);
  cloud.normals.emplace_back(normal);
  cloud.radii.push_back(static_cast<float>(radius));
  cloud.weights.push_back(even_weight());
  cloud.colors->values.emplace_back(color.r, color.g, color.b);
}

surfel::SurfelCloud colored_cloud() {
  surfel::SurfelCloud cloud;
  cloud.colors = surfel::ColorAttribute{8, {}};
  cloud.oriented = true;
  return cloud;
}

void name_source(surfel::SurfelCloud& cloud) {
  cloud.sources = {{"generated", 0, cloud.size(), {}}};
}

}  // namespace

surfel::SurfelCloud fibonacci_sphere(size_t count, double radius, const glm::dvec3& centre, const glm::u8vec3& color) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double spacing = radius * std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
  surfel::SurfelCloud cloud = colored_cloud();
  for (size_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double ring = std::sqrt(1 - z * z);
    const double angle = golden_angle * static_cast<double>(i);
    const glm::dvec3 n(ring * std::cos(angle), ring * std::sin(angle), z);
    add(cloud, centre + radius * n, n, surfel::kRadiusOverSpacing * spacing, color);
  }
  name_source(cloud);
  return cloud;
}

surfel::SurfelCloud square(int side, double extent, const glm::dvec3& centre, const glm::dvec3& normal,
                           const glm::u8vec3& color) {
  const glm::dvec3 n = glm::normalize(normal);
  const glm::dvec3 a = glm::normalize(glm::cross(std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), n));
  const glm::dvec3 b = glm::cross(n, a);
  const double spacing = extent / side;
  surfel::SurfelCloud cloud = colored_cloud();
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double u = (column + 0.5) * spacing - 0.5 * extent;
      const double v = (row + 0.5) * spacing - 0.5 * extent;
      add(cloud, centre + u * a + v * b, n, surfel::kRadiusOverSpacing * spacing, color);
    }
  }
  name_source(cloud);
  return cloud;
}

surfel::SurfelCloud single_surfel(const glm::dvec3& position, const glm::vec3& normal, float radius,
                                  const glm::u8vec3& color) {
  surfel::SurfelCloud cloud = colored_cloud();
  add(cloud, position, normal, radius, color);
  name_source(cloud);
  return cloud;
}

void append(surfel::SurfelCloud& cloud, const surfel::SurfelCloud& more) {
  cloud.positions.insert(cloud.positions.end(), more.positions.begin(), more.positions.end());
  cloud.normals.insert(cloud.normals.end(), more.normals.begin(), more.normals.end());
  cloud.radii.insert(cloud.radii.end(), more.radii.begin(), more.radii.end());
  cloud.weights.insert(cloud.weights.end(), more.weights.begin(), more.weights.end());
  cloud.colors->values.insert(cloud.colors->values.end(), more.colors->values.begin(), more.colors->values.end());
  name_source(cloud);
}

}  // namespace surfcast::testing
