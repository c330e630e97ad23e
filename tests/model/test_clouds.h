#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// Declares one source without a grid for the whole cloud, and fills missing attributes with default values.
inline surfel::SurfelCloud finish_cloud(surfel::SurfelCloud cloud) {
  cloud.normals.resize(cloud.size(), glm::vec3(0, 0, 1));
  cloud.radii.resize(cloud.size(), 1.0f);
  cloud.weights.resize(cloud.size(), 1.0f);
  if (cloud.sources.empty()) cloud.sources.push_back({"generated", 0, cloud.size(), std::nullopt});
  return cloud;
}

/// Points spread evenly over a sphere about the origin (a golden angle spiral), with outward normals and colours.
inline surfel::SurfelCloud sphere_cloud(size_t count, double radius = 1) {
  surfel::SurfelCloud cloud;
  cloud.oriented = true;
  cloud.colors.emplace();
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double r = std::sqrt(1 - z * z);
    const double angle = golden * static_cast<double>(i);
    const glm::dvec3 direction(r * std::cos(angle), r * std::sin(angle), z);
    cloud.positions.push_back(radius * direction);
    cloud.normals.emplace_back(direction);
    cloud.colors->values.emplace_back(glm::u16vec3(glm::round((direction + 1.0) * 127.5)));
  }
  const double spacing = radius * std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
  cloud.radii.assign(count, static_cast<float>(spacing));
  return finish_cloud(std::move(cloud));
}

/// Adds the attribute "id": the number of each surfel in the cloud, which identifies it in tests.
inline void number_surfels(surfel::SurfelCloud& cloud) {
  std::vector<uint32_t> ids(cloud.size());
  std::iota(ids.begin(), ids.end(), 0);
  cloud.scalars.push_back({"id", std::move(ids)});
}

}  // namespace surfcast::model
