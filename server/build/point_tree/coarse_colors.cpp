#include "point_tree/coarse_colors.h"

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "estimation/neighbours.h"
#include "estimation/sites.h"
#include "surfel/srgb.h"

namespace surfcast::point_tree {
namespace {

/// Standard deviation of the weights, in radii of the surfel.
constexpr double kWidth = 0.7;

/// Neighbours that count: further ones are two spacings away, where weights are small.
constexpr size_t kNeighbours = 12;

/// How much the colour of `other` counts for `own` beside the distance: on a surface only that of the same sheet.
double likeness(const surfel::SurfelCloud& cloud, uint32_t own, uint32_t other) {
  if (cloud.is_scatter(own)) return 1;
  if (cloud.is_scatter(other)) return 0;
  return std::abs(double{glm::dot(cloud.normals[own], cloud.normals[other])});
}

}  // namespace

std::vector<glm::u16vec3> coarse_colors(const surfel::SurfelCloud& cloud) {
  const surfel::ColorAttribute& colors = *cloud.colors;
  const estimation::Sites sites = estimation::find_sites(cloud.positions, cloud.bounds());
  const std::vector<uint32_t> surfels = sites.points();
  std::vector<glm::vec3> light;
  light.reserve(sites.size());
  for (const uint32_t surfel : surfels) light.push_back(surfel::to_linear(colors.values[surfel], colors.bits));
  std::vector<glm::u16vec3> means(sites.size(), colors.values[surfels.front()]);
  estimation::for_each_neighbourhood(sites, kNeighbours, [&](const estimation::Neighbours& near) {
    const uint32_t own = surfels[near.site];
    const double width = kWidth * double{cloud.radii[own]} / sites.unit;
    glm::dvec3 sum(light[near.site]);
    double weights = 1;
    for (size_t k = 0; k < near.ids.size(); ++k) {
      const double distance = std::exp(-near.squared_distances[k] / (2 * width * width));
      const double weight = distance * likeness(cloud, own, surfels[near.ids[k]]);
      sum += weight * glm::dvec3(light[near.ids[k]]);
      weights += weight;
    }
    means[near.site] = surfel::from_linear(glm::vec3(sum / weights), colors.bits);
  });
  std::vector<glm::u16vec3> of_surfels;
  of_surfels.reserve(cloud.size());
  for (const uint32_t site : sites.of_point) of_surfels.push_back(means[site]);
  return of_surfels;
}

}  // namespace surfcast::point_tree
