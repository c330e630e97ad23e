#include "support/clouds.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "shared/kernel.h"

namespace surfcast::testing {

SurfelCloud fibonacci_sphere(size_t count, double radius, const glm::dvec3& centre, const glm::u8vec3& color) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double spacing = radius * std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
  const double sigma = SURFCAST_KERNEL_SIGMA * 1.08;
  SurfelCloud cloud;
  cloud.colors = ColorAttribute{8, {}};
  for (size_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double ring = std::sqrt(1 - z * z);
    const double angle = golden_angle * static_cast<double>(i);
    const glm::dvec3 n(ring * std::cos(angle), ring * std::sin(angle), z);
    cloud.positions.push_back(centre + radius * n);
    cloud.normals.emplace_back(n);
    cloud.radii.push_back(static_cast<float>(1.08 * spacing));
    cloud.weights.push_back(static_cast<float>(1 / (2 * std::numbers::pi * sigma * sigma)));
    cloud.colors->values.emplace_back(color.r, color.g, color.b);
  }
  cloud.sources = {{"sphere", 0, count, {}}};
  cloud.oriented = true;
  return cloud;
}

}  // namespace surfcast::testing
