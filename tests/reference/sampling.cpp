#include "reference/sampling.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "base/contract.h"
#include "estimation/spacing.h"
#include "reference/linear_picture.h"

namespace surfcast::reference {
namespace {

constexpr size_t kNeighbours = 12;  ///< as in the builder

}  // namespace

std::vector<SurfacePoint> jittered_square(int side, double jitter, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(0.5 - jitter, 0.5 + jitter);
  std::vector<SurfacePoint> points;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double u = (x + offset(random)) / side;
      const double v = (y + offset(random)) / side;
      points.push_back(square_point({2 * u - 1, 2 * v - 1}));
    }
  }
  return points;
}

std::vector<SurfacePoint> random_square(int count, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    points.push_back(square_point({x, y}));
  }
  return points;
}

std::vector<SurfacePoint> random_sphere(int count, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> coordinate(0, 1);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    const double z = coordinate(random);
    points.push_back(sphere_point({x, y, z}));
  }
  return points;
}

std::vector<SurfacePoint> jittered_sphere(int count, double jitter, uint32_t seed) {
  std::mt19937 random(seed);
  const double spacing = std::sqrt(4 * std::numbers::pi / count);
  std::uniform_real_distribution<double> offset(-jitter * spacing, jitter * spacing);
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double r = std::sqrt(1 - z * z);
    const glm::dvec3 p{r * std::cos(golden_angle * i), r * std::sin(golden_angle * i), z};
    const glm::dvec3 east = glm::normalize(glm::dvec3(-p.y, p.x, 0));
    const glm::dvec3 north = glm::cross(p, east);
    const double x = offset(random);
    const double y = offset(random);
    points.push_back(sphere_point(p + x * east + y * north));
  }
  return points;
}

surfel::SurfelCloud surfels_at(const std::vector<SurfacePoint>& points) {
  SURFCAST_EXPECTS(points.size() > 1);
  surfel::SurfelCloud cloud;
  cloud.oriented = true;
  for (const SurfacePoint& p : points) {
    cloud.positions.push_back(p.position);
    cloud.normals.emplace_back(p.normal);
  }
  const estimation::Sites sites = estimation::find_sites(cloud.positions, cloud.bounds());
  std::vector<glm::vec3> normals(sites.size());
  for (size_t i = 0; i < points.size(); ++i) normals[sites.of_point[i]] = cloud.normals[i];
  const std::vector<float> radii =
      estimation::estimate_radii(sites, estimation::find_neighbours(sites, kNeighbours), normals);
  for (const uint32_t site : sites.of_point) cloud.radii.push_back(radii[site]);
  cloud.sources = {{"scene", 0, points.size(), std::nullopt}};
  return cloud;
}

surfel::ColorAttribute sampled_colors(const std::vector<SurfacePoint>& points, const Texture& texture) {
  surfel::ColorAttribute colors;
  for (const SurfacePoint& p : points) colors.values.emplace_back(srgb8_from_linear(texture(p.uv)));
  return colors;
}

}  // namespace surfcast::reference
