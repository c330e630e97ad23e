#include "scan/make_surfels.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatEq;

ScanPoints scan_of(std::vector<glm::dvec3> positions, bool z_up = true) {
  ScanPoints scan;
  scan.name = "scan";
  scan.positions = std::move(positions);
  scan.z_up = z_up;
  return scan;
}

SurfelCloud surfels_of(ScanPoints scan) {
  SurfelReport report;
  std::vector<ScanPoints> scans;
  scans.push_back(std::move(scan));
  Result<SurfelCloud> cloud = make_surfels(std::move(scans), report);
  EXPECT_TRUE(cloud);
  return cloud ? *std::move(cloud) : SurfelCloud{};
}

std::vector<glm::dvec3> square_lattice(int side, double spacing, const glm::dvec3& corner) {
  std::vector<glm::dvec3> positions;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) positions.push_back(corner + spacing * glm::dvec3(x, y, 0));
  }
  return positions;
}

/// Points spread evenly over a sphere (Fibonacci spiral).
std::vector<glm::dvec3> sphere(int count, const glm::dvec3& centre, double radius) {
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    positions.push_back(centre + radius * glm::dvec3(r * std::cos(angle), r * std::sin(angle), z));
  }
  return positions;
}

TEST(MakeSurfelsTest, PlaneHasItsNormalUpwardsAndTheRadiusOfItsLattice) {
  const SurfelCloud cloud = surfels_of(scan_of(square_lattice(9, 0.5, {0, 0, 3})));
  EXPECT_TRUE(cloud.oriented);
  for (const glm::vec3& n : cloud.normals) EXPECT_NEAR(n.z, 1, 1e-6);
  // Four neighbours at h and two at h sqrt 2.
  EXPECT_FLOAT_EQ(cloud.radii[4 * 9 + 4], static_cast<float>((4 + 2 * std::numbers::sqrt2) / 6 * 0.5));
}

TEST(MakeSurfelsTest, SphereNormalsPointOutwards) {
  const glm::dvec3 centre(10, -4, 2);
  const SurfelCloud cloud = surfels_of(scan_of(sphere(2000, centre, 3), false));
  EXPECT_TRUE(cloud.oriented);
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_GT(glm::dot(glm::dvec3(cloud.normals[i]), glm::normalize(cloud.positions[i] - centre)), 0.99);
  }
}

TEST(MakeSurfelsTest, MillimetresAtFiveMillionMetresKeepTheirSpacing) {
  const SurfelCloud cloud = surfels_of(scan_of(square_lattice(9, 0.001, {500000, 5000000, 100})));
  EXPECT_NEAR(cloud.radii[4 * 9 + 4], (4 + 2 * std::numbers::sqrt2) / 6 * 0.001, 1e-8);
  for (const glm::vec3& n : cloud.normals) EXPECT_NEAR(n.z, 1, 1e-6);
}

TEST(MakeSurfelsTest, SinglePointGetsADefinedSurfel) {
  const SurfelCloud cloud = surfels_of(scan_of({{1, 2, 3}}));
  EXPECT_THAT(cloud.normals, ElementsAre(glm::vec3(0, 0, 1)));
  EXPECT_THAT(cloud.radii, ElementsAre(1.0F));
}

TEST(MakeSurfelsTest, CollinearPointsGetUnitNormalsAcrossTheLine) {
  std::vector<glm::dvec3> line;
  for (int i = 0; i < 20; ++i) line.push_back(static_cast<double>(i) * glm::dvec3(1, 2, -1));
  const SurfelCloud cloud = surfels_of(scan_of(line));
  for (const glm::vec3& n : cloud.normals) {
    EXPECT_NEAR(glm::length(n), 1, 1e-6);
    EXPECT_NEAR(glm::dot(n, glm::vec3(1, 2, -1)), 0, 1e-5);
  }
}

TEST(MakeSurfelsTest, NotFinitePointsAndExactDuplicatesAreDroppedAndCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ScanPoints scan = scan_of({{0, 0, 0}, {nan, 0, 0}, {1, 0, 0}, {0, INFINITY, 0}, {1, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}});
  scan.scalars.push_back({"intensity", std::vector<uint16_t>{1, 2, 3, 4, 3, 9, 1}});
  std::vector<ScanPoints> scans;
  scans.push_back(std::move(scan));
  SurfelReport report;
  const Result<SurfelCloud> cloud = make_surfels(std::move(scans), report);
  ASSERT_TRUE(cloud);
  EXPECT_THAT(cloud->positions, ElementsAre(glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(1, 0, 0)));
  EXPECT_THAT(std::get<std::vector<uint16_t>>(cloud->scalars[0].values), ElementsAre(1, 3, 9));
  EXPECT_EQ(report.points_read, 7u);
  EXPECT_EQ(report.not_finite, 2u);
  EXPECT_EQ(report.duplicates, 2u);
  // The two that share a position are both at distance 1 from the third.
  EXPECT_THAT(cloud->radii, Each(FloatEq(1)));
}

}  // namespace
}  // namespace surfcast
