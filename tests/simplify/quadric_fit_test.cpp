// Fits of osculating surfaces against surfaces whose curvature is known.

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "simplify/point_tree.h"
#include "simplify/smooth_scenes.h"

namespace surfcast::simplify {
namespace {

using surfel::OsculatingSurface;

std::vector<Sample> around(const std::vector<Sample>& samples, const glm::dvec3& centre, double reach) {
  std::vector<Sample> near;
  for (const Sample& s : samples) {
    if (glm::distance(s.position, centre) <= reach) near.push_back(s);
  }
  return near;
}

/// Samples of a sphere within an angle of its pole.
std::vector<Sample> cap(double radius, double angle, size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Sample> samples;
  while (samples.size() < count) {
    const double z = 1 - share(random) * (1 - std::cos(angle));
    const double turn = 2 * std::numbers::pi * share(random);
    const double r = std::sqrt(1 - z * z);
    const glm::dvec3 n(r * std::cos(turn), r * std::sin(turn), z);
    samples.push_back({radius * n, n});
  }
  return samples;
}

TEST(QuadricFit, FindsTheCurvatureOfASphere) {
  const std::vector<Sample> samples = cap(5, 0.2, 60);
  const auto fit = fit_surface(samples.front().position, samples, true);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->curvature.uu, 0.2, 0.004);
  EXPECT_NEAR(fit->curvature.vv, 0.2, 0.004);
  EXPECT_NEAR(fit->curvature.uv, 0, 0.004);
  EXPECT_NEAR(glm::length(fit->centre), 5, 0.002);
  EXPECT_GT(glm::dot(fit->normal, samples.front().normal), std::cos(0.002));
}

TEST(QuadricFit, IsTheSameForNormalsOnEitherSideOfASheet) {
  std::vector<Sample> samples = cap(5, 0.2, 60);
  for (size_t i = 1; i < samples.size(); i += 2) samples[i].normal = -samples[i].normal;
  const auto fit = fit_surface(samples.front().position, samples, false);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->curvature.largest(), 0.2, 0.004);
}

TEST(QuadricFit, IsNoneWhereSamplesLieOnALine) {
  std::vector<Sample> samples;
  for (int i = 0; i < 20; ++i) samples.push_back({{0.1 * i, 0, 0}, {0, 0, 1}});
  const auto fit = fit_surface(samples[10].position, samples, true);
  // Normals across the line are known, heights beside it are not: what is found is the plane that they state.
  if (fit) {
    EXPECT_LT(fit->curvature.largest(), 1e-6);
  }
  EXPECT_FALSE(fit_surface(samples[0].position, std::vector<Sample>(20, samples[0]), true));
}

/// Root mean square error of both principal curvatures over their own, on 20,000 samples of a torus with noise.
double curvature_error(double shift, double degrees, size_t neighbours) {
  std::vector<Sample> samples = testing::random_samples(testing::torus(), 20000, 3);
  const double area = 4 * std::numbers::pi * std::numbers::pi * 0.4;
  const double spacing = std::sqrt(area / 20000);
  const std::vector<Sample> exact = samples;
  testing::add_noise(samples, spacing, shift, degrees, 4);
  const double reach = spacing * std::sqrt(static_cast<double>(neighbours) / std::numbers::pi);
  double error = 0;
  double size = 0;
  for (size_t i = 0; i < samples.size(); i += 50) {
    const auto fit = fit_surface(samples[i].position, around(samples, samples[i].position, reach), true);
    if (!fit) continue;
    // On the torus: 1 / 0.4 around the tube, and cos(a) / (1 + 0.4 cos(a)) along it.
    const double across = std::hypot(exact[i].position.x, exact[i].position.y) - 1;
    const double k2 = across / 0.4 / (1 + across);
    const surfel::Curvature& k = fit->curvature;
    const double mean = 0.5 * (k.uu + k.vv);
    const double half = 0.5 * std::hypot(k.uu - k.vv, 2 * k.uv);
    error += std::pow(mean + half - 2.5, 2) + std::pow(mean - half - k2, 2);
    size += 2.5 * 2.5 + k2 * k2;
  }
  return std::sqrt(error / size);
}

TEST(QuadricFit, FindsTheCurvatureOfATorusThroughNoise) {
  EXPECT_LT(curvature_error(0, 0, 40), 0.03);
  EXPECT_LT(curvature_error(0.05, 2, 40), 0.08);
  EXPECT_LT(curvature_error(0.2, 8, 40), 0.28);
}

TEST(OsculatingSurface, MeetsRaysAtSilhouettesWhereThePlaneIsEdgeOn) {
  // A sphere of radius 1 at distance 10, by its surfel at the rim: the ray that touches the sphere meets it there.
  const glm::dvec3 eye_to_centre(0, 0, 10);
  const double sine = 1.0 / 10;
  const glm::dvec3 n(std::sqrt(1 - sine * sine), 0, -sine);
  OsculatingSurface surface{eye_to_centre + n, n, surfel::tangent_frame(n), {1, 0, 1}};
  const glm::dvec3 rim = eye_to_centre + n;
  const auto inside = surfel::meet(surface, rim / rim.z * glm::dvec3(0.9999, 1, 1), true);
  ASSERT_TRUE(inside);
  EXPECT_NEAR(glm::dot(inside->normal, glm::normalize(rim)), 0, 0.06);
  EXPECT_LT(glm::dot(inside->normal, rim), 0);
  EXPECT_FALSE(surfel::meet(surface, rim / rim.z * glm::dvec3(1.0001, 1, 1), true));
}

TEST(OsculatingSurface, OfAPlaneIsItsPlane) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.3, -0.2, -1));
  const OsculatingSurface surface{{0.5, 0.2, 7}, n, surfel::tangent_frame(n), {}};
  const glm::dvec3 ray(0.1, 0.05, 1);
  const auto hit = surfel::meet(surface, ray, true);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, glm::dot(n, surface.centre) / glm::dot(n, ray), 1e-12);
  EXPECT_FALSE(surfel::meet({surface.centre, -n, surfel::tangent_frame(-n), {}}, ray, true));
  EXPECT_TRUE(surfel::meet({surface.centre, -n, surfel::tangent_frame(-n), {}}, ray, false));
}

TEST(CurvatureCode, ComesBackToWithinAStepAndBoundsWhatIsStored) {
  const surfel::Curvature k{0.31, -0.12, 0.5};
  const surfel::Curvature back = surfel::decode_curvature(surfel::encode_curvature(k, 1.5), 1.5);
  EXPECT_NEAR(back.uu, k.uu, 0.5 / 511 / 1.5);
  EXPECT_NEAR(back.uv, k.uv, 0.5 / 511 / 1.5);
  EXPECT_NEAR(back.vv, k.vv, 0.5 / 511 / 1.5);
  surfel::SurfelCloud cloud;
  cloud.positions.resize(1);
  surfel::add_curvature({{32767, -32768, 3, -5}}, cloud);
  const surfel::CurvatureColumns columns(cloud.scalars);
  ASSERT_FALSE(columns.empty());
  EXPECT_EQ(columns.at(0), (surfel::CurvatureCode{511, -511, 3, 0}));
}

TEST(BorderCode, ComesBackToWithinAStep) {
  EXPECT_FALSE(surfel::decode_border(0));
  EXPECT_FALSE(surfel::decode_border(-300));
  for (int i = 0; i < 20; ++i) {
    const surfel::Border border{{std::cos(i), std::sin(i)}, 0.05 + 0.05 * i};
    const auto back = surfel::decode_border(surfel::encode_border(border));
    ASSERT_TRUE(back);
    EXPECT_GT(glm::dot(back->direction, border.direction), std::cos(0.013));
    EXPECT_NEAR(back->distance, border.distance, 0.5 / surfel::kBorderSteps);
  }
}

TEST(TangentFrame, IsOrthonormalEverywhere) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const surfel::TangentFrame f = surfel::tangent_frame(n);
    EXPECT_NEAR(glm::dot(f.u, f.u), 1, 1e-9);
    EXPECT_NEAR(glm::dot(f.u, f.v), 0, 1e-9);
    EXPECT_NEAR(glm::distance(glm::cross(f.u, f.v), n), 0, 1e-9);
  }
}

TEST(PointTree, FindsWhatASearchOfAllPointsFinds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<glm::dvec3> points(3000);
  for (glm::dvec3& p : points) p = {place(random), place(random), 0.1 * place(random)};
  const PointTree tree(points);
  std::vector<Near> near;
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 centre(place(random), place(random), 0);
    tree.within(centre, 0.15, near);
    const auto inside = [&](const glm::dvec3& p) { return glm::distance(p, centre) <= 0.15; };
    EXPECT_EQ(near.size(), static_cast<size_t>(std::count_if(points.begin(), points.end(), inside)));
  }
}

TEST(PointTree, OfAStrideFindsEveryQuarterOfTheBallAlike) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<glm::dvec3> points(100000);
  for (glm::dvec3& p : points) p = {place(random), place(random), 0};
  const PointTree tree(points);
  std::vector<Near> all;
  std::vector<Near> some;
  const glm::dvec3 centre(0.1, -0.2, 0);
  for (const uint32_t stride : {2U, 16U, 64U}) {
    tree.within(centre, 0.7, all);
    tree.within(centre, 0.7, some, stride);
    std::array<size_t, 4> quarters{};
    for (const Near& n : some) {
      const glm::dvec3 d = points[n.point] - centre;
      EXPECT_LE(glm::dot(d, d), 0.49);
      ++quarters.at((d.x > 0 ? 1 : 0) + (d.y > 0 ? 2 : 0));
    }
    const double expected = static_cast<double>(all.size()) / (4 * stride);
    for (const size_t count : quarters) EXPECT_NEAR(static_cast<double>(count), expected, 0.1 * expected + 8);
  }
}

}  // namespace
}  // namespace surfcast::simplify
