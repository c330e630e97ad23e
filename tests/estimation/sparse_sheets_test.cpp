// Walls of few points beside surfaces of many, as scans from the air have them.

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "estimation/make_surfels.h"
#include "scan/shapes.h"
#include "scan/surfels_of.h"

namespace surfcast::estimation {
namespace {

using testing::WholeScan;

constexpr double kHeight = 15;    // metres, of the wall
constexpr double kLength = 60;    // of the wall
constexpr double kGround = 4;     // points per square metre, seen from above
constexpr double kSparse = 0.25;  // on the wall
constexpr double kNoise = 0.04;   // standard deviation of the ranges
const double kGroundRadius = 1 / std::sqrt(kGround);

/// Points spread evenly over an area, moved by the noise along `normal`.
void add_plane(double density, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, std::mt19937& random,
               std::vector<glm::dvec3>& points) {
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise(0, kNoise);
  const glm::dvec3 across = glm::cross(u, v);
  const auto count = static_cast<int>(density * glm::length(across));
  for (int i = 0; i < count; ++i) {
    const double a = share(random);
    const double b = share(random);
    points.push_back(corner + a * u + b * v + noise(random) * glm::normalize(across));
  }
}

/// A stand of a stadium that leans on a wall, and plain ground before it. The wall is at x = 0 and faces +x.
struct Stadium {
  std::vector<glm::dvec3> points;
  size_t wall = 0;  ///< first point of the wall
};

Stadium stadium(double wall_density = kSparse) {
  std::mt19937 random(3);
  Stadium made;
  add_plane(kGround, {0, 0, 0}, {40, 0, 0}, {0, kLength, 0}, random, made.points);
  add_plane(kGround, {-15, 0, 3}, {15, 0, kHeight - 3}, {0, kLength, 0}, random, made.points);
  made.wall = made.points.size();
  add_plane(wall_density, {0, 0, 0}, {0, kLength, 0}, {0, 0, kHeight}, random, made.points);
  return made;
}

surfel::SurfelCloud surfels_of_scene(std::vector<glm::dvec3> positions, std::optional<glm::dvec3> scanner = {}) {
  WholeScan scan;
  scan.positions = std::move(positions);
  scan.sensor = scanner;
  SurfelReport report;
  std::vector<WholeScan> scans;
  scans.push_back(std::move(scan));
  return testing::surfels_of(std::move(scans), report);
}

/// The share of the points from `first` on for which `holds(i)` is true.
double share_of(const surfel::SurfelCloud& cloud, size_t first, const std::function<bool(size_t)>& holds) {
  double count = 0;
  for (size_t i = first; i < cloud.size(); ++i) count += holds(i) ? 1 : 0;
  return count / static_cast<double>(cloud.size() - first);
}

TEST(SparseSheets, AWallBesideDenserSurfacesIsAWall) {
  const Stadium scene = stadium();
  const surfel::SurfelCloud cloud = surfels_of_scene(scene.points);
  const auto upright = [&](size_t i) { return !cloud.is_scatter(i) && std::abs(cloud.normals[i].x) > 0.95F; };
  EXPECT_GT(share_of(cloud, scene.wall, upright), 0.8) << "0.42 by the nearest neighbours alone";
}

TEST(SparseSheets, ItsDiscsCloseTheWall) {
  const Stadium scene = stadium();
  const surfel::SurfelCloud cloud = surfels_of_scene(scene.points);
  double covered = 0;
  double all = 0;
  for (double y = 5; y < kLength - 5; y += 0.5) {
    for (double z = 2; z < kHeight - 2; z += 0.5) {
      const auto reaches = [&](size_t i) {
        const glm::dvec3 d = cloud.positions[i] - glm::dvec3(cloud.positions[i].x, y, z);
        return std::abs(cloud.normals[i].x) > 0.95F && glm::length(d) < double{cloud.radii[i]};
      };
      all += 1;
      for (size_t i = scene.wall; i < cloud.size(); ++i) {
        if (!reaches(i)) continue;
        covered += 1;
        break;
      }
    }
  }
  EXPECT_GT(covered / all, 0.9);
}

TEST(SparseSheets, NoDiscIsWiderThanThreeAndAHalfTimesTheRadiusAround) {
  // One point on five square metres: 3.5 times the radius around does not close this wall any more.
  const surfel::SurfelCloud cloud = surfels_of_scene(stadium(0.2).points);
  EXPECT_LT(*std::ranges::max_element(cloud.radii), 3.5F * 1.6F * static_cast<float>(kGroundRadius));
}

TEST(SparseSheets, TheDenserSurfacesStayAsTheyAre) {
  const Stadium scene = stadium();
  const std::vector<glm::dvec3> without(scene.points.begin(),
                                        scene.points.begin() + static_cast<std::ptrdiff_t>(scene.wall));
  const surfel::SurfelCloud with_wall = surfels_of_scene(scene.points);
  const surfel::SurfelCloud alone = surfels_of_scene(without);
  double changed = 0;
  for (size_t i = 0; i < alone.size(); ++i) {
    const bool same = with_wall.is_scatter(i) == alone.is_scatter(i) && with_wall.radii[i] < 1.2F * alone.radii[i] &&
                      with_wall.radii[i] > 0.8F * alone.radii[i];
    changed += same ? 0 : 1;
  }
  EXPECT_LT(changed / static_cast<double>(alone.size()), 0.03);
}

TEST(SparseSheets, TreesAndStraysAreNoSheets) {
  std::mt19937 random(4);
  std::vector<glm::dvec3> points;
  add_plane(kGround, {0, 0, 0}, {60, 0, 0}, {0, 60, 0}, random, points);
  const size_t ground = points.size();
  // Crowns as dense as the ground, and a thin haze over all of it.
  for (const glm::dvec3& p : testing::noise(1500, 12)) points.push_back(p + glm::dvec3(10, 10, 1));
  for (const glm::dvec3& p : testing::noise(300, 60)) points.emplace_back(p.x, p.y, 0.5 + 0.3 * p.z);
  const surfel::SurfelCloud cloud = surfels_of_scene(points);
  EXPECT_LT(share_of(cloud, ground, [&](size_t i) { return !cloud.is_scatter(i); }), 0.06);
  EXPECT_LT(*std::ranges::max_element(cloud.radii), 2 * 1.6F * static_cast<float>(kGroundRadius));
}

TEST(SparseSheets, AreNotLookedForWhereTheScannerIsKnown) {
  const Stadium scene = stadium();
  const surfel::SurfelCloud cloud = surfels_of_scene(scene.points, glm::dvec3(30, 30, 2));
  const auto upright = [&](size_t i) { return !cloud.is_scatter(i) && std::abs(cloud.normals[i].x) > 0.95F; };
  EXPECT_LT(share_of(cloud, scene.wall, upright), 0.6);
}

TEST(SparseSheets, ThreadsDoNotChangeThem) {
  const auto make = [](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return surfels_of_scene(stadium().points);
  };
  const surfel::SurfelCloud one = make(1);
  const surfel::SurfelCloud four = make(4);
  EXPECT_EQ(one.scatter, four.scatter);
  EXPECT_EQ(one.radii, four.radii);
  EXPECT_EQ(one.normals, four.normals);
}

}  // namespace
}  // namespace surfcast::estimation
