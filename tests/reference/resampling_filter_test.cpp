#include "reference/resampling_filter.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::reference {
namespace {

constexpr double kEta = 800;  // pixels
constexpr double kTiny = 1e-6;

/// One cutoff for every gain, so that only the form under test varies.
KernelParameters uniform_cutoff() {
  KernelParameters kernel;
  kernel.cutoff_minified = kernel.cutoff_magnified = 9;
  return kernel;
}

Splat splat_at(const glm::dvec3& o, const glm::dvec3& n, double radius, double prefilter) {
  const auto splat = Splat::make(o, glm::normalize(n), radius, kEta, prefilter, uniform_cutoff());
  EXPECT_TRUE(splat.has_value());
  return *splat;
}

/// |u|^2 / sigma^2 of the intersection u of the ray with the surfel's plane.
double object_space_r2(const glm::dvec3& o, const glm::dvec3& n, double radius, const glm::dvec3& d) {
  const glm::dvec3 unit = glm::normalize(n);
  const glm::dvec3 u = glm::dot(unit, o) / glm::dot(unit, d) * d - o;
  const double sigma = SURFCAST_KERNEL_SIGMA * radius;
  return glm::dot(u, u) / (sigma * sigma);
}

glm::dvec3 ray_beside(const glm::dvec3& o, double x_pixels, double y_pixels) {
  return {o.x / o.z + x_pixels / kEta, o.y / o.z + y_pixels / kEta, 1};
}

TEST(ResamplingFilter, OfAFrontalSurfelIsTheSumOfTwoRoundGaussians) {
  const glm::dvec3 o{0, 0, 4};
  const Splat splat = splat_at(o, {0, 0, -1}, 0.01, 1);
  const double s = SURFCAST_KERNEL_SIGMA * 0.01 * kEta / 4;  // pixels
  const Fragment f = splat.fragment(ray_beside(o, 1.5, -2));
  EXPECT_NEAR(f.r2, (1.5 * 1.5 + 2 * 2) / (s * s + 1), 1e-9);
  EXPECT_NEAR(f.gain, s * s / (s * s + 1), 1e-12);
}

TEST(ResamplingFilter, WithoutPrefilterIsTheKernelOnTheSurfaceForAnyTilt) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 o{uniform(random), uniform(random), 2.5 + uniform(random)};
    const glm::dvec3 n{uniform(random), uniform(random), uniform(random)};
    const double radius = 0.4 + 0.3 * uniform(random);
    if (std::abs(glm::dot(glm::normalize(n), o)) < 0.05) continue;  // cancellation in the closed form
    const glm::dvec3 d = ray_beside(o, 40 * uniform(random), 40 * uniform(random));
    if (std::abs(glm::dot(glm::normalize(n), d)) < 0.02) continue;
    const double expected = object_space_r2(o, n, radius, d);
    EXPECT_NEAR(splat_at(o, n, radius, kTiny).fragment(d).r2 / expected, 1, 1e-6) << "case " << i;
  }
}

TEST(ResamplingFilter, OfATinySurfelIsThePrefilterAlone) {
  const glm::dvec3 o{0.3, -0.2, 2};
  const Splat splat = splat_at(o, {0.5, 0.2, -1}, 1e-7, 1);
  const Fragment f = splat.fragment(ray_beside(o, 0.7, 1.1));
  EXPECT_NEAR(f.r2, 0.7 * 0.7 + 1.1 * 1.1, 1e-6);
  EXPECT_LT(f.gain, 1e-6);
}

TEST(ResamplingFilter, StaysFiniteAndContinuousUpToEdgeOn) {
  const glm::dvec3 o{0, 0, 2};
  const glm::dvec3 d = ray_beside(o, 0.4, 0.9);
  const Fragment edge_on = splat_at(o, {1, 0, 0}, 0.05, 1).fragment(d);
  EXPECT_TRUE(std::isfinite(edge_on.r2));
  for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999, 90.0, 90.0001}) {
    const double angle = glm::radians(degrees);
    const Splat splat = splat_at(o, {std::sin(angle), 0, -std::cos(angle)}, 0.05, 1);
    const Fragment f = splat.fragment(d);
    EXPECT_GE(f.gain, 0);
    EXPECT_LE(f.gain, 1);
    EXPECT_NEAR(f.r2 / edge_on.r2, 1, 2 * std::abs(90 - degrees)) << degrees;
    EXPECT_TRUE(std::isfinite(splat.fragment_depth(d))) << degrees;
    EXPECT_GE(splat.disc_depth(d).pushed, splat.fragment_depth(d)) << degrees;
  }
}

TEST(ResamplingFilter, PutsCoplanarFragmentsInFrontOfEveryDiscOfTheirPlane) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(0, 1, -0.03));  // a floor seen at about two degrees
  const glm::dvec3 o{0, -0.05, 2};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> pixels(-4, 4);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 d = ray_beside(o, pixels(random), pixels(random));
    const glm::dvec3 other = o + glm::dvec3(0.002 * i, 0, 0) + glm::dvec3(0, 0.03, 1) * (0.002 * (i - 100));
    EXPECT_LE(splat_at(o, n, 0.001, 1).fragment_depth(d), splat_at(other, n, 0.001, 1).disc_depth(d).pushed)
        << "case " << i;
  }
}

TEST(ResamplingFilter, BoundsHoldEveryPixelOfTheSplat) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 o{uniform(random), uniform(random), 1.5 + uniform(random)};
    const auto splat = Splat::make(o, glm::normalize(glm::dvec3{uniform(random), uniform(random), uniform(random)}),
                                   0.5 + 0.45 * uniform(random), kEta, 1, uniform_cutoff());
    ASSERT_TRUE(splat.has_value());
    const Splat::Bounds bounds = splat->bounds();
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 d{3 * uniform(random), 3 * uniform(random), 1};
      const bool inside = d.x >= bounds.min.x && d.x <= bounds.max.x && d.y >= bounds.min.y && d.y <= bounds.max.y;
      EXPECT_TRUE(inside || (splat->cut(splat->fragment(d).r2) && !splat->opaque(d))) << "case " << i;
    }
  }
}

TEST(ResamplingFilter, RefusesWhatIsNoSurfel) {
  const KernelParameters kernel;
  const double nan = std::nan("");
  EXPECT_FALSE(Splat::make({0, 0, 1}, {0, 0, 0}, 0.1, kEta, 1, kernel));
  EXPECT_FALSE(Splat::make({0, 0, 1}, {0, nan, 1}, 0.1, kEta, 1, kernel));
  EXPECT_FALSE(Splat::make({nan, 0, 1}, {0, 0, 1}, 0.1, kEta, 1, kernel));
  EXPECT_FALSE(Splat::make({0, 0, 1}, {0, 0, 1}, 0, kEta, 1, kernel));
  EXPECT_FALSE(Splat::make({0, 0, 1}, {0, 0, 1}, nan, kEta, 1, kernel));
  EXPECT_FALSE(Splat::make({0, 0, -1}, {0, 0, 1}, 0.1, kEta, 1, kernel)) << "behind the eye";
}

}  // namespace
}  // namespace surfcast::reference
