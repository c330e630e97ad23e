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

/// How much the colour of `other` counts for `own` beside the distance: on a surface only that of the same sheet.
double likeness(const surfel::SurfelCloud& cloud, uint32_t own, uint32_t other) {
  if (cloud.is_scatter(own)) return 1;
  if (cloud.is_scatter(other)) return 0;
  return std::abs(double{glm::dot(cloud.normals[own], cloud.normals[other])});
}

}  // namespace

std::vector<glm::u16vec3> coarse_colors(const estimation::Neighbourhoods& neighbourhoods,
                                        const surfel::SurfelCloud& cloud) {
  const surfel::ColorAttribute& colors = *cloud.colors;
  const estimation::Sites& sites = neighbourhoods.sites;
  const std::vector<uint32_t> surfels = sites.points();
  std::vector<glm::vec3> light;
  light.reserve(sites.size());
  for (const uint32_t surfel : surfels) light.push_back(surfel::to_linear(colors.values[surfel], colors.bits));
  std::vector<glm::u16vec3> means(sites.size(), colors.values[surfels.front()]);
  for (size_t site = 0; site < sites.size(); ++site) {
    const uint32_t own = surfels[site];
    const double width = kWidth * double{cloud.radii[own]} / sites.unit;
    glm::dvec3 sum(light[site]);
    double weights = 1;
    for (const uint32_t near : neighbourhoods.graph.of(site)) {
      const glm::dvec3 step = sites.positions[near] - sites.positions[site];
      const double distance = std::exp(-glm::dot(step, step) / (2 * width * width));
      const double weight = distance * likeness(cloud, own, surfels[near]);
      sum += weight * glm::dvec3(light[near]);
      weights += weight;
    }
    means[site] = surfel::from_linear(glm::vec3(sum / weights), colors.bits);
  }
  std::vector<glm::u16vec3> of_surfels;
  of_surfels.reserve(cloud.size());
  for (const uint32_t site : sites.of_point) of_surfels.push_back(means[site]);
  return of_surfels;
}

}  // namespace surfcast::point_tree
