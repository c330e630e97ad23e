// Points that lie on no surface, from points to the kinds and radii of surfels.

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "estimation/make_surfels.h"
#include "scan/shapes.h"
#include "scan/surfels_of.h"

namespace surfcast::estimation {
namespace {

using testing::WholeScan;

constexpr double kSpacing = 0.1;

surfel::SurfelCloud surfels_at(std::vector<glm::dvec3> positions) {
  WholeScan scan;
  scan.positions = std::move(positions);
  SurfelReport report;
  std::vector<WholeScan> scans;
  scans.push_back(std::move(scan));
  return testing::surfels_of(std::move(scans), report);
}

/// Moves every point by up to `share` of the spacing along each axis of `axes`.
std::vector<glm::dvec3> jittered(std::vector<glm::dvec3> positions, double share, const glm::dvec3& axes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-share * kSpacing, share * kSpacing);
  for (glm::dvec3& p : positions) {
    const double x = jitter(random);
    const double y = jitter(random);
    p += axes * glm::dvec3(x, y, jitter(random));
  }
  return positions;
}

std::vector<glm::dvec3> plane(int side = 60) {
  return jittered(testing::square_lattice(side, kSpacing, {0, 0, 0}), 0.25, {1, 1, 0});
}

template <typename Wanted>
double share_of_scatter(const surfel::SurfelCloud& cloud, Wanted wanted) {
  double scatter = 0;
  double all = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (!wanted(cloud.positions[i])) continue;
    all += 1;
    scatter += cloud.is_scatter(i) ? 1 : 0;
  }
  return scatter / all;
}

bool anywhere(const glm::dvec3& /*p*/) {
  return true;
}

TEST(Scatter, SurfacesHaveNone) {
  EXPECT_TRUE(surfels_at(plane()).scatter.empty());
  EXPECT_TRUE(surfels_at(testing::sphere(5000, {1, 2, 3}, 4)).scatter.empty());
  // Noise across the surface of a fifth of the spacing.
  EXPECT_TRUE(surfels_at(jittered(plane(), 0.2, {0, 0, 1})).scatter.empty());
}

TEST(Scatter, SurfacesKeepTheirRadii) {
  const surfel::SurfelCloud cloud = surfels_at(testing::square_lattice(60, kSpacing, {0, 0, 0}));
  const auto middle = static_cast<size_t>(30 * 60 + 30);
  EXPECT_NEAR(cloud.radii[middle], (4 + 2 * std::numbers::sqrt2) / 6 * kSpacing, 1e-6);
}

TEST(Scatter, AVolumeIsScatterWithSplatsOfHalfTheDistanceToTheNearest) {
  constexpr int kCount = 20000;
  constexpr double kSize = 10;
  const surfel::SurfelCloud cloud = surfels_at(testing::noise(kCount, kSize));
  const auto inside = [](const glm::dvec3& p) {
    const glm::dvec3 d = glm::abs(p - kSize / 2);
    return std::max({d.x, d.y, d.z}) < 0.4 * kSize;
  };
  EXPECT_GT(share_of_scatter(cloud, inside), 0.95);
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (!inside(cloud.positions[i]) || !cloud.is_scatter(i)) continue;
    sum += double{cloud.radii[i]};
    ++count;
  }
  // The mean distance to the third nearest of a Poisson process of density n is Gamma(10 / 3) / Gamma(3) times
  // (4 pi n / 3)^(-1/3).
  const double density = kCount / std::pow(kSize, 3);
  const double third = std::tgamma(10.0 / 3) / 2 * std::cbrt(3 / (4 * std::numbers::pi * density));
  EXPECT_NEAR(sum / count, 0.3 * third, 0.01 * third);
}

TEST(Scatter, AWireIsScatterThatJustCloses) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(i * kSpacing, 0.3 * i * kSpacing, 5 + 1e-4 * i * i * kSpacing);
  const surfel::SurfelCloud cloud = surfels_at(points);
  EXPECT_EQ(share_of_scatter(cloud, anywhere), 1);
  const double spacing = glm::distance(points[100], points[101]);
  // The third nearest is the second along the line on one side.
  EXPECT_NEAR(cloud.radii[100], 0.3 * 2 * spacing, 0.01 * spacing);
}

TEST(Scatter, AScanLineOfASurfaceIsASurface) {
  // Lines eight times as far apart as the points on them: the twelve nearest are one line, the 32 nearest are several.
  std::vector<glm::dvec3> points;
  for (int line = 0; line < 30; ++line) {
    for (int i = 0; i < 200; ++i) points.emplace_back(i * kSpacing, line * 8 * kSpacing, 0);
  }
  const surfel::SurfelCloud cloud = surfels_at(jittered(points, 0.02, {1, 1, 1}));
  const auto inside = [](const glm::dvec3& p) {
    return p.x > 30 * kSpacing && p.x < 170 * kSpacing && p.y > 40 * kSpacing && p.y < 190 * kSpacing;
  };
  EXPECT_LT(share_of_scatter(cloud, inside), 0.01);
}

/// A wall as a depth camera at the origin measures it, which looks along z: a step of depth is `step` distance^2, and
/// depths are off by a third of a step. `slant`: tangent of the angle to the picture's plane.
std::vector<glm::dvec3> stepped_wall(double distance, double slant) {
  constexpr double kFocal = 525;  // pixels
  constexpr double kStep = 0.00285;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.3);
  std::vector<glm::dvec3> points;
  for (int row = -60; row < 60; ++row) {
    for (int column = -80; column < 80; ++column) {
      const glm::dvec3 ray((column + 0.5) / kFocal, (row + 0.5) / kFocal, 1);
      const double steps = (1 - slant * ray.x) / (kStep * distance) + noise(random);
      points.push_back(ray / (kStep * std::round(steps)));
    }
  }
  return points;
}

TEST(Scatter, LayersOfAWallMeasuredInStepsOfDepthAreSurfaces) {
  // Without layers 99, 61, 41 and 10 % are scatter.
  EXPECT_LT(share_of_scatter(surfels_at(stepped_wall(2, 0)), anywhere), 0.25);
  EXPECT_LT(share_of_scatter(surfels_at(stepped_wall(2, 1)), anywhere), 0.35);
  EXPECT_LT(share_of_scatter(surfels_at(stepped_wall(3, 1)), anywhere), 0.03);
  EXPECT_LT(share_of_scatter(surfels_at(stepped_wall(4.5, 2)), anywhere), 0.01);
}

TEST(Scatter, LayersCloseTheWallTogetherAndAreNoWider) {
  const surfel::SurfelCloud cloud = surfels_at(stepped_wall(3, 1));
  constexpr double kPixel = 3.0 / 525;
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT(double{cloud.radii[i]}, 3 * kPixel * cloud.positions[i].z / 3) << i;
  }
}

TEST(Scatter, SheetsOneBehindTheOtherAreSurfacesOfTheirOwn) {
  // Beyond twelve neighbours those of the other sheet come in, but each sheet goes on behind or in front of them.
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 50; ++i) {
    for (int j = 0; j < 50; ++j) {
      for (const double z : {0.0, 3.0}) points.emplace_back(i, j, z);
    }
  }
  const surfel::SurfelCloud cloud = surfels_at(points);
  EXPECT_LT(share_of_scatter(cloud, anywhere), 0.01);
  std::vector<float> radii = cloud.radii;
  std::ranges::nth_element(radii, radii.begin() + 2500);
  EXPECT_NEAR(radii[2500], (4 + 2 * std::sqrt(2)) / 6, 0.02);
}

TEST(Scatter, MostOfASheetBeforeAnotherHasTheRadiiOfTheSheetAloneUpToItsBorder) {
  constexpr int kSide = 40;
  const std::vector<glm::dvec3> sheet = plane(kSide);
  std::vector<glm::dvec3> sheets = sheet;
  for (const glm::dvec3& p : sheet) sheets.push_back(p + glm::dvec3(0, 0, 3 * kSpacing));
  const surfel::SurfelCloud alone = surfels_at(sheet);
  const surfel::SurfelCloud both = surfels_at(sheets);
  const auto within = [&](double x) { return x > 0.5 * kSpacing && x < (kSide - 1.5) * kSpacing; };
  int narrower = 0;
  for (size_t i = 0; i < alone.size(); ++i) {
    if (!within(alone.positions[i].x) || !within(alone.positions[i].y)) continue;
    const auto same = std::ranges::find(both.positions, alone.positions[i]);
    ASSERT_NE(same, both.positions.end());
    narrower += both.radii[static_cast<size_t>(same - both.positions.begin())] < 0.95F * alone.radii[i] ? 1 : 0;
  }
  EXPECT_LT(narrower, 100);  // of 1444
}

TEST(Scatter, LeavesAreNoLayers) {
  // A crown of 400 leaves of nine points: each is flat, in a direction of its own.
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& leaf : testing::noise(400, 10)) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 other(normal(random), normal(random), normal(random));
    const glm::dvec3 v = glm::normalize(glm::cross(u, other));
    for (int k = 0; k < 9; ++k) points.push_back(leaf + 0.15 * (k % 3) * u + 0.15 * (k / 3) * v);
  }
  EXPECT_GT(share_of_scatter(surfels_at(points), anywhere), 0.83) << "0.85 without layers";
}

TEST(Scatter, AStrayAboveAPlaneIsNoWiderThanHalfThePlanesRadius) {
  std::vector<glm::dvec3> points = plane();
  points.emplace_back(3, 3, 2);
  points.emplace_back(3, 3, 40);
  const surfel::SurfelCloud cloud = surfels_at(points);
  for (const size_t stray : {points.size() - 2, points.size() - 1}) {
    EXPECT_TRUE(cloud.is_scatter(stray));
    EXPECT_LE(cloud.radii[stray], 0.6 * kSpacing);
    EXPECT_GT(cloud.radii[stray], 0.4 * kSpacing);
  }
  EXPECT_EQ(share_of_scatter(cloud, [](const glm::dvec3& p) { return p.z == 0; }), 0);
}

/// A plane with strays around it: alone, in pairs, and in a row of single points away from it.
std::vector<glm::dvec3> plane_and_strays() {
  std::vector<glm::dvec3> points = plane();
  for (int i = 0; i < 12; ++i) points.emplace_back(0.5 * i, 2 + 0.1 * (i % 3), 0.4 * (1 + i % 5));
  for (int i = 0; i < 4; ++i) points.emplace_back(8 + 3 * i, 3, 0);
  points.emplace_back(1, 1, 60);
  points.emplace_back(1, 1, 60 + kSpacing);
  return points;
}

TEST(Scatter, NoRadiusIsAboveFourSpacingsOfTheSurfaceAround) {
  const surfel::SurfelCloud cloud = surfels_at(plane_and_strays());
  EXPECT_LE(*std::max_element(cloud.radii.begin(), cloud.radii.end()), 4 * kSpacing);
}

TEST(Scatter, ASparseSurfaceBesideADenseOneKeepsItsRadii) {
  constexpr double kFactor = 8;
  std::vector<glm::dvec3> points = plane();
  const size_t dense = points.size();
  for (const glm::dvec3& p : plane()) points.push_back(kFactor * p + glm::dvec3(60 * kSpacing, 0, 0));
  const surfel::SurfelCloud cloud = surfels_at(points);
  EXPECT_LE(*std::max_element(cloud.radii.begin(), cloud.radii.begin() + static_cast<std::ptrdiff_t>(dense)),
            4 * kSpacing);
  const auto middle = dense + static_cast<size_t>(30 * 60 + 30);
  EXPECT_FALSE(cloud.is_scatter(middle));
  EXPECT_GT(cloud.radii[middle], 4 * kSpacing);
  EXPECT_LT(cloud.radii[middle], 2 * kFactor * kSpacing);
}

TEST(Scatter, TwoPlanesAreScatterAtMostWhereTheyCross) {
  std::vector<glm::dvec3> points = plane();
  for (const glm::dvec3& p : plane()) points.emplace_back(p.x, 3, p.y - 3);
  const surfel::SurfelCloud cloud = surfels_at(points);
  const auto far_off = [](const glm::dvec3& p) { return std::abs(p.y - 3) + std::abs(p.z) > 4 * kSpacing; };
  EXPECT_EQ(share_of_scatter(cloud, far_off), 0);
}

TEST(Scatter, PairedEchoesInATreeDoNotMakeTinySplats) {
  std::vector<glm::dvec3> points = testing::noise(4000, 5);
  const size_t alone = points.size();
  const surfel::SurfelCloud single = surfels_at(points);
  for (size_t i = 0; i < alone; ++i) points.push_back(points[i] + glm::dvec3(0, 0, 1e-5));
  const surfel::SurfelCloud paired = surfels_at(points);
  double before = 0;
  double after = 0;
  for (size_t i = 0; i < alone; ++i) {
    before += double{single.radii[i]};
    after += double{paired.radii[i]};
  }
  EXPECT_GT(after, 0.5 * before);
}

TEST(Scatter, StatedRadiiAreDiscsAsTheFileHasThem) {
  WholeScan scan;
  scan.positions = testing::noise(4000, 5);
  scan.radii.assign(scan.positions.size(), 0.7F);
  SurfelReport report;
  std::vector<WholeScan> scans;
  scans.push_back(std::move(scan));
  const surfel::SurfelCloud cloud = testing::surfels_of(std::move(scans), report, RadiusPolicy::kKeep);
  EXPECT_TRUE(cloud.scatter.empty());
  EXPECT_EQ(std::count(cloud.radii.begin(), cloud.radii.end(), 0.7F), 4000);
  EXPECT_EQ(report.scatter, 0U);
}

TEST(Scatter, PointsWhoseStatedRadiiAreReplacedByEstimatesMayBeScatter) {
  WholeScan scan;
  scan.positions = testing::noise(4000, 5);
  scan.radii.assign(scan.positions.size(), 700.0F);
  SurfelReport report;
  std::vector<WholeScan> scans;
  scans.push_back(std::move(scan));
  const surfel::SurfelCloud cloud = testing::surfels_of(std::move(scans), report);
  EXPECT_LT(*std::max_element(cloud.radii.begin(), cloud.radii.end()), 5.0F);
  EXPECT_EQ(report.scatter, static_cast<uint64_t>(std::count(cloud.scatter.begin(), cloud.scatter.end(), 1)));
  EXPECT_GT(report.scatter, 2000U);
}

TEST(Scatter, TheReportCountsIt) {
  WholeScan scan;
  scan.positions = plane();
  scan.positions.emplace_back(3, 3, 2);
  SurfelReport report;
  std::vector<WholeScan> scans;
  scans.push_back(std::move(scan));
  testing::surfels_of(std::move(scans), report);
  EXPECT_EQ(report.scatter, 1U);
}

/// A plane with a cloud of points and a stray above it.
std::vector<glm::dvec3> scene() {
  std::vector<glm::dvec3> points = plane();
  for (const glm::dvec3& p : testing::noise(3000, 2)) points.push_back(p + glm::dvec3(2, 2, 0.5));
  points.emplace_back(1, 1, 3);
  return points;
}

TEST(Scatter, KindsAndRadiiDoNotDependOnTheOrderOfThePoints) {
  const std::vector<glm::dvec3> points = scene();
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  std::vector<glm::dvec3> shuffled;
  for (const size_t i : order) shuffled.push_back(points[i]);
  const surfel::SurfelCloud cloud = surfels_at(points);
  const surfel::SurfelCloud other = surfels_at(shuffled);
  for (size_t i = 0; i < order.size(); ++i) {
    ASSERT_EQ(other.is_scatter(i), cloud.is_scatter(order[i])) << i;
    ASSERT_EQ(other.radii[i], cloud.radii[order[i]]) << i;
  }
}

TEST(Scatter, ThreadsDoNotChangeIt) {
  const auto make = [](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return surfels_at(scene());
  };
  const surfel::SurfelCloud one = make(1);
  const surfel::SurfelCloud four = make(4);
  EXPECT_EQ(one.scatter, four.scatter);
  EXPECT_EQ(one.radii, four.radii);
}

}  // namespace
}  // namespace surfcast::estimation
