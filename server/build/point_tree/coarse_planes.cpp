#include "point_tree/coarse_planes.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "estimation/neighbours.h"
#include "estimation/sites.h"

namespace surfcast::point_tree {
namespace {

/// Discs so far away count, and a point lies in the plane of a disc if it is so close to it. Both in radii of the disc.
constexpr double kReach = 3;
constexpr double kClose = 0.25;
/// Discs around whose planes have to agree, and their share of all discs around.
constexpr size_t kAgreeing = 2;
constexpr double kAgreeingShare = 2.0 / 3;
/// Of the radius of the disc: its plane ends somewhere near the point.
constexpr float kRadiusShare = 0.7F;

/// Where a point is seen from a disc, in radii of the disc.
struct Place {
  double distance = 0;
  double height = 0;  ///< above its plane, or below
};

Place place_of(const surfel::SurfelCloud& cloud, uint32_t point, uint32_t disc) {
  const glm::dvec3 step = (cloud.positions[point] - cloud.positions[disc]) / double{cloud.radii[disc]};
  return {glm::length(step), std::abs(glm::dot(step, glm::dvec3(cloud.normals[disc])))};
}

/// The disc whose plane a point adopts; none if the discs around do not agree.
std::optional<uint32_t> find_plane(const surfel::SurfelCloud& cloud, uint32_t point,
                                   const std::vector<uint32_t>& surfels, std::span<const uint32_t> near) {
  size_t discs = 0, agreeing = 0;
  double nearest = std::numeric_limits<double>::infinity();
  uint32_t found = 0;
  for (const uint32_t site : near) {
    const uint32_t disc = surfels[site];
    if (cloud.is_scatter(disc)) continue;
    const Place place = place_of(cloud, point, disc);
    if (place.distance > kReach) continue;
    ++discs;
    if (place.height > kClose) continue;
    ++agreeing;
    if (place.distance >= nearest) continue;
    nearest = place.distance;
    found = disc;
  }
  if (agreeing < kAgreeing || static_cast<double>(agreeing) < kAgreeingShare * static_cast<double>(discs)) {
    return std::nullopt;
  }
  return found;
}

}  // namespace

void adopt_planes(const estimation::Neighbourhoods& neighbourhoods, surfel::SurfelCloud& cloud) {
  if (cloud.scatter.empty()) return;
  const estimation::Sites& sites = neighbourhoods.sites;
  const std::vector<uint32_t> surfels = sites.points();
  std::vector<std::optional<uint32_t>> planes(sites.size());
  for (size_t site = 0; site < sites.size(); ++site) {
    const uint32_t own = surfels[site];
    if (cloud.is_scatter(own)) planes[site] = find_plane(cloud, own, surfels, neighbourhoods.graph.of(site));
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    const std::optional<uint32_t> plane = planes[sites.of_point[i]];
    if (!plane || !cloud.is_scatter(i)) continue;
    cloud.scatter[i] = 0;
    cloud.normals[i] = cloud.normals[*plane];
    cloud.radii[i] = kRadiusShare * cloud.radii[*plane];
  }
}

}  // namespace surfcast::point_tree
