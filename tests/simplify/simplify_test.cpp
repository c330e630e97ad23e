// Simplified clouds keep the error that they state, and are refused where they do not pay.

#include "simplify/simplify.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include <gtest/gtest.h>

#include "simplify/point_tree.h"
#include "simplify/smooth_scenes.h"

namespace surfcast::simplify {
namespace {

using testing::ImplicitSurface;

struct Simplified {
  surfel::SurfelCloud before;
  surfel::SurfelCloud after;
  SimplifyReport report;
};

Simplified simplified(const ImplicitSurface& surface, size_t count, const ErrorBound& bound, double shift = 0,
                      double degrees = 0) {
  std::vector<Sample> samples = testing::random_samples(surface, count, 11);
  const double spacing = testing::spacing_of(samples, testing::even_subset(samples, count / 4)) / 2;
  testing::add_noise(samples, spacing, shift, degrees, 12);
  Simplified result;
  result.before = testing::surfels_of(samples, 1.08 * spacing);
  result.after = result.before;
  result.report = simplify(bound, result.after);
  return result;
}

/// The 90th percentile of the angles, degrees, and the largest distance between samples of the surface and the nearest
/// of the drawn surfaces that reach them; samples that none reaches are counted.
struct Measured {
  double degrees = 0;
  double height = 0;
  size_t uncovered = 0;
};

Measured measure(const surfel::SurfelCloud& before, const surfel::SurfelCloud& after) {
  const surfel::CurvatureColumns columns(after.scalars);
  const PointTree tree(after.positions);
  const float widest = *std::max_element(after.radii.begin(), after.radii.end());
  std::vector<Near> near;
  std::vector<double> angles;
  Measured measured;
  for (size_t i = 0; i < before.size(); ++i) {
    tree.within(before.positions[i], 1.5 * widest, near);
    const double kNone = 1e9;
    double best = kNone;
    double angle = 0;
    double height = 0;
    for (const Near& n : near) {
      const glm::dvec3 normal(after.normals[n.point]);
      const double radius = after.radii[n.point];
      const surfel::OsculatingSurface s{after.positions[n.point], normal, surfel::tangent_frame(normal),
                                        surfel::decode_curvature(columns.at(n.point), radius)};
      const glm::dvec2 place = s.place(before.positions[i]) / radius;
      const glm::dvec3 there = s.normal_at(s.place(before.positions[i]));
      if (glm::dot(place, place) > 1 || glm::dot(there, glm::dvec3(before.normals[i])) < 0.3) continue;
      const double h = std::abs(s.height(before.positions[i]));
      if (h > radius || glm::dot(place, place) > best) continue;
      best = glm::dot(place, place);
      height = h;
      angle = std::acos(std::min(1.0, glm::dot(there, glm::dvec3(before.normals[i])))) * 180 / std::numbers::pi;
    }
    if (best == kNone) {
      ++measured.uncovered;
      continue;
    }
    angles.push_back(angle);
    measured.height = std::max(measured.height, height);
  }
  const auto ninth = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() * 9 / 10);
  std::nth_element(angles.begin(), ninth, angles.end());
  measured.degrees = *ninth;
  return measured;
}

class SimplifyBounds : public ::testing::TestWithParam<double> {};

TEST_P(SimplifyBounds, AreKeptOnTheTorus) {
  const Simplified s = simplified(testing::torus(), 20000, {GetParam(), std::nullopt});
  ASSERT_TRUE(s.report.pays) << s.report.reason;
  EXPECT_LE(s.report.degrees, GetParam());
  const Measured m = measure(s.before, s.after);
  std::cout << GetParam() << " degrees: " << s.after.size() << " surfels, " << m.degrees << " degrees, height "
            << m.height << " stated " << s.report.height << "\n";
  EXPECT_LE(m.degrees, GetParam());
  EXPECT_LE(m.height, 1.1 * s.report.height + 1e-4);  // and the rounding of codes
  EXPECT_EQ(m.uncovered, 0U);
  EXPECT_GT(s.report.curved, s.report.points / 2);
}

TEST_P(SimplifyBounds, AreKeptOnTheBumpySphere) {
  const Simplified s = simplified(testing::bumpy_sphere(), 40000, {2 * GetParam(), std::nullopt});
  std::cout << s.report.reason << s.report.points << "\n";
  ASSERT_TRUE(s.report.pays) << s.report.reason;
  const Measured m = measure(s.before, s.after);
  std::cout << 2 * GetParam() << " degrees: " << s.after.size() << " surfels, " << m.degrees << " degrees, height "
            << m.height << " stated " << s.report.height << "\n";
  EXPECT_LE(m.degrees, 2 * GetParam());
  EXPECT_LE(m.height, 1.1 * s.report.height + 1e-4);
  EXPECT_EQ(m.uncovered, 0U);
}

INSTANTIATE_TEST_SUITE_P(Degrees, SimplifyBounds, ::testing::Values(2.0, 4.0));

TEST(Simplify, KeepsItsBoundWhereSmallNeighbourhoodsAreBent) {
  for (const testing::ImplicitSurface& surface : {testing::spring(), testing::blob()}) {
    const Simplified s = simplified(surface, 20000, {1, std::nullopt});
    std::cout << surface.name << ": " << s.report.points << " points, kept " << s.report.kept << ", "
              << s.report.degrees << " degrees\n";
    EXPECT_LE(s.report.degrees, 1) << surface.name;
    EXPECT_TRUE(!s.report.pays || measure(s.before, s.after).degrees <= 1) << surface.name;
  }
}

TEST(Simplify, KeepsThePointsOfPartsThatItDoesNotFit) {
  std::vector<Sample> samples = testing::random_samples(testing::torus(), 20000, 11);
  std::vector<Sample> spring = testing::random_samples(testing::spring(), 5000, 12);
  for (Sample& sample : spring) sample.position.x += 4;
  samples.insert(samples.end(), spring.begin(), spring.end());
  const surfel::SurfelCloud before = testing::surfels_of(samples, 0.03);
  surfel::SurfelCloud after = before;
  const SimplifyReport report = simplify({2, std::nullopt}, after);
  std::cout << report.points << " points, kept " << report.kept << ", " << report.degrees << " degrees\n";
  ASSERT_TRUE(report.pays) << report.reason;
  EXPECT_LE(report.degrees, 2);
  EXPECT_GT(report.kept, 3000U);
  EXPECT_LT(report.points, 10000U);
  const auto of_spring = [](const surfel::SurfelCloud& cloud) {
    return std::ranges::count_if(cloud.positions, [](const glm::dvec3& p) { return p.x > 2.5; });
  };
  EXPECT_GT(of_spring(after), 3000);
  EXPECT_LT(static_cast<ptrdiff_t>(after.size()) - of_spring(after), 5000);
  EXPECT_EQ(measure(before, after).uncovered, 0U);
}

TEST(Simplify, KeepsAStatedHeight) {
  const Simplified s = simplified(testing::torus(), 20000, {8, 0.002});
  ASSERT_TRUE(s.report.pays) << s.report.reason;
  EXPECT_LE(s.report.height, 0.002);
  EXPECT_LE(measure(s.before, s.after).height, 0.0025);
}

TEST(Simplify, TakesFewPointsForTheFacesOfABoxAndDoesNotGoOverItsEdges) {
  const Simplified s = simplified(testing::box(), 20000, {2, std::nullopt});
  ASSERT_TRUE(s.report.pays) << s.report.reason;
  for (size_t i = 0; i < s.after.size(); ++i) {
    // Half a spacing over the edge, as surfels of a border.
    const glm::dvec3 reach = glm::dvec3(s.after.radii[i]) * (1.0 - glm::abs(glm::dvec3(s.after.normals[i])));
    EXPECT_LT(glm::length(glm::max(glm::abs(s.after.positions[i]) + reach - 0.7, glm::dvec3(0))), 0.3);
  }
}

TEST(Simplify, GrowsThroughNoise) {
  const Simplified s = simplified(testing::torus(), 30000, {4, std::nullopt}, 0.2, 8);
  std::cout << s.report.points << " points, kept " << s.report.kept << ", " << s.report.degrees << "\n";
  ASSERT_TRUE(s.report.pays) << s.report.reason;
  EXPECT_LT(s.after.size(), 1500U);
  EXPECT_EQ(measure(s.before, s.after).uncovered, 0U);
}

TEST(Simplify, LeavesCloudsAsTheyAreWhereASurfelStandsForFewPoints) {
  const Simplified s = simplified(testing::bumpy_sphere(), 4000, {0.2, std::nullopt});
  EXPECT_FALSE(s.report.pays);
  EXPECT_NE(s.report.reason.find("fewer than 20"), std::string::npos);
  EXPECT_EQ(s.after.positions, s.before.positions);
  EXPECT_TRUE(s.after.scalars.empty());
}

TEST(Simplify, KeepsScatterAndMeansOfColours) {
  std::vector<Sample> samples = testing::random_samples(testing::torus(), 20000, 11);
  surfel::SurfelCloud cloud = testing::surfels_of(samples, 0.03);
  cloud.scatter.assign(cloud.size(), 0);
  cloud.scatter[5] = cloud.scatter[77] = 1;
  cloud.colors = surfel::ColorAttribute{8, std::vector<glm::u16vec3>(cloud.size(), {200, 100, 50})};
  const glm::dvec3 leaf = cloud.positions[77];
  ASSERT_TRUE(simplify({4, std::nullopt}, cloud).pays);
  EXPECT_EQ(std::count(cloud.scatter.begin(), cloud.scatter.end(), 1), 2);
  const auto at = std::find(cloud.positions.begin(), cloud.positions.end(), leaf);
  ASSERT_NE(at, cloud.positions.end());
  EXPECT_TRUE(cloud.is_scatter(static_cast<size_t>(at - cloud.positions.begin())));
  EXPECT_EQ(cloud.colors->values.size(), cloud.size());
  for (const glm::u16vec3& c : cloud.colors->values) EXPECT_EQ(c, glm::u16vec3(200, 100, 50));
  EXPECT_EQ(cloud.sources.front().count, cloud.size());
}

}  // namespace
}  // namespace surfcast::simplify
