#include "reference/ray_kernel.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <random>

#include <gtest/gtest.h>

#include "reference/affine_kernel.h"
#include "reference/light_picture.h"

namespace surfcast::reference {
namespace {

constexpr double kRayEta = 500;  // pixels per unit of tangent

glm::dmat3 rotated(const glm::dvec3& deviations, const glm::dvec3& axis, double angle) {
  const glm::dmat3 rotation = glm::mat3_cast(glm::angleAxis(angle, glm::normalize(axis)));
  return {deviations.x * rotation[0], deviations.y * rotation[1], deviations.z * rotation[2]};
}

/// Integrals along the ray through d: of the kernel, and of z times it, between two depths.
struct Quadrature {
  double length = 0;
  double depth = 0;  // mean of z
};
Quadrature integrate(const glm::dvec3& o, const glm::dmat3& factor, const glm::dvec3& d, double z0, double z1) {
  constexpr int kSteps = 200'000;
  const glm::dmat3 whiten = glm::inverse(factor);
  Quadrature sum;
  for (int i = 0; i < kSteps; ++i) {
    const double z = z0 + (i + 0.5) / kSteps * (z1 - z0);
    const glm::dvec3 x = whiten * (z * d - o);
    const double value = std::exp(-0.5 * glm::dot(x, x)) * (z1 - z0) / kSteps;
    sum.length += value * glm::length(d);
    sum.depth += value * z;
  }
  sum.depth *= glm::length(d) / sum.length;
  return sum;
}

struct Case {
  const char* what;
  glm::dvec3 o;
  glm::dmat3 factor;
  glm::dvec3 d;
};

std::vector<Case> cases() {
  const glm::dvec3 tilt{1, 2, -1};
  return {{"outside", {0.3, -0.2, 4}, rotated({0.3, 0.2, 0.5}, tilt, 0.8), {0.1, -0.02, 1}},
          {"corner of a wide view", {4, 3, 3}, rotated({0.3, 0.2, 0.5}, tilt, 0.8), {1.4, 1.1, 1}},
          {"eye within", {0.1, 0.05, 0.2}, rotated({0.5, 0.4, 0.6}, tilt, 1.1), {0.2, 0.3, 1}},
          {"eye at the centre", {0, 0, 0}, rotated({0.5, 0.4, 0.6}, tilt, 1.1), {0.2, 0.3, 1}},
          {"astride the eye's plane", {0.4, 0.1, 0}, rotated({0.3, 0.2, 0.9}, tilt, 0.3), {0.8, 0.3, 1}},
          {"centre behind the eye", {0.2, 0.1, -0.3}, rotated({0.3, 0.5, 0.6}, tilt, 0.3), {-0.2, 0.3, 1}},
          {"needle across", {0.1, 0.2, 3}, rotated({1, 1e-3, 1e-3}, {0, 0, 1}, 0.7), {0.0337, 0.06699, 1}},
          {"needle towards the eye", {0, 0, 3}, rotated({1e-3, 1e-3, 1}, {1, 0, 0}, 0.001), {0.0002, 0.0004, 1}},
          {"disc at a slant", {0.3, 0.1, 2}, rotated({0.5, 0.5, 1e-3}, {1, 0, 0}, 1.3), {0.1, 0.03, 1}}};
}

TEST(RayKernel, IsTheIntegralAlongTheRayWhereverTheEyeIs) {
  for (const Case& c : cases()) {
    const Quadrature expected = integrate(c.o, c.factor, c.d, -12, 12);
    const KernelOnRay seen = RayKernel(c.o, c.factor, kRayEta, 0).on_ray(c.d);
    EXPECT_NEAR(seen.length / expected.length, 1, 1e-6) << c.what;
    EXPECT_NEAR(seen.depth, expected.depth, 1e-5) << c.what;
  }
}

TEST(RayKernel, SharesAreTheIntegralsBetweenDepths) {
  for (const Case& c : cases()) {
    const KernelOnRay seen = RayKernel(c.o, c.factor, kRayEta, 0).on_ray(c.d);
    const double z0 = seen.depth - 0.4 * seen.deviation;
    const double z1 = seen.depth + 1.3 * seen.deviation;
    const double part = integrate(c.o, c.factor, c.d, z0, z1).length;
    EXPECT_NEAR(share_between(seen, z0, z1) * seen.length / part, 1, 1e-6) << c.what;
  }
}

TEST(RayKernel, SharesOfSlabsAddUpToTheKernel) {
  const KernelOnRay seen =
      RayKernel({0.3, -0.2, 4}, rotated({0.3, 0.2, 0.5}, {1, 2, -1}, 0.8), kRayEta, 1).on_ray({0.1, -0.02, 1});
  double sum = 0;
  for (int slab = 0; slab < 80; ++slab) sum += share_between(seen, 0.1 * slab, 0.1 * (slab + 1));
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(RayKernel, WithoutThicknessIsTheHitOfRayAndDisc) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const glm::dmat3 axes = rotated({1, 1, 1}, {uniform(random), uniform(random), 1.1}, 3 * uniform(random));
    const glm::dvec3 o{uniform(random), uniform(random), 2 + uniform(random)};
    const glm::dvec3 d{0.5 * uniform(random), 0.5 * uniform(random), 1};
    if (std::abs(glm::dot(axes[2], d)) < 0.05) continue;  // cancellation in the expected value
    const double t = glm::dot(axes[2], o) / glm::dot(axes[2], d);
    const double u = glm::dot(t * d - o, axes[0]) / 0.4;
    const double v = glm::dot(t * d - o, axes[1]) / 0.3;
    const KernelOnRay seen = RayKernel(o, {0.4 * axes[0], 0.3 * axes[1], glm::dvec3(0)}, kRayEta, 0).on_ray(d);
    EXPECT_NEAR(seen.r2 / (u * u + v * v), 1, 1e-9);
    EXPECT_NEAR(seen.depth, t, 1e-9 * (1 + std::abs(t)));
    EXPECT_NEAR(seen.deviation, 0, 1e-7);
    EXPECT_NEAR(seen.gain, std::exp(-0.5 * seen.r2), 1e-12);
  }
}

TEST(RayKernel, WithAPrefilterIsTheIntegralsOfTheRaysAroundFiltered) {
  const glm::dvec3 o{0.2, 0.1, 5};
  const glm::dmat3 factor = rotated({0.02, 0.006, 0.03}, {1, 2, -1}, 0.8);  // 2 px by 0.6 px
  const RayKernel sharp(o, factor, kRayEta, 0);
  for (const double offset : {0.0, 1.0, 2.5}) {
    const glm::dvec3 d{o.x / o.z + offset / kRayEta, o.y / o.z - 0.5 * offset / kRayEta, 1};
    double sum = 0;
    double weights = 0;
    for (int row = -50; row <= 50; ++row) {
      for (int column = -50; column <= 50; ++column) {
        const double x = 0.1 * column;  // pixels
        const double y = 0.1 * row;
        const double weight = std::exp(-0.5 * (x * x + y * y));
        weights += weight;
        sum += weight * sharp.on_ray(d + glm::dvec3(x, y, 0) / kRayEta).length;
      }
    }
    EXPECT_NEAR(RayKernel(o, factor, kRayEta, 1).on_ray(d).length / (sum / weights), 1, 0.01) << offset;
  }
}

TEST(RayKernel, BoundsHoldEveryRayWithinTheCutoffAndNoMore) {
  constexpr double kCutoff = 9;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 o{2 * uniform(random), 2 * uniform(random), 1.5 + uniform(random)};
    const glm::dmat3 factor = rotated({0.2, 0.02, 0.1 + 0.09 * uniform(random)},
                                      {uniform(random), uniform(random), 1.1}, 3 * uniform(random));
    const RayKernel kernel(o, factor, kRayEta, 1);
    const auto bounds = kernel.bounds(kCutoff);
    if (!bounds) continue;
    const glm::dvec2 size = bounds->max - bounds->min;
    glm::dvec2 low(1e9);
    glm::dvec2 high(-1e9);
    for (int y = -20; y <= 220; ++y) {
      for (int x = -20; x <= 220; ++x) {
        const glm::dvec2 at = bounds->min + size * glm::dvec2(x, y) / 200.0;
        if (!(kernel.on_ray({at, 1}).r2 <= kCutoff)) continue;
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_GE(low[axis], bounds->min[axis] - 1e-9 * size[axis]) << i;
      EXPECT_LE(high[axis], bounds->max[axis] + 1e-9 * size[axis]) << i;
      EXPECT_LE(low[axis], bounds->min[axis] + 0.1 * size[axis]) << i;
      EXPECT_GE(high[axis], bounds->max[axis] - 0.1 * size[axis]) << i;
    }
  }
}

TEST(RayKernel, HasNoBoundsWhereItReachesTheEyesPlane) {
  const glm::dmat3 factor(0.1);
  EXPECT_TRUE(RayKernel({0, 0, 0.31}, factor, kRayEta, 1).bounds(9).has_value());
  EXPECT_FALSE(RayKernel({0, 0, 0.29}, factor, kRayEta, 1).bounds(9).has_value());
  EXPECT_FALSE(RayKernel({0, 0, -0.29}, factor, kRayEta, 1).behind(9));
  EXPECT_TRUE(RayKernel({0, 0, -0.31}, factor, kRayEta, 1).behind(9));
}

TEST(RayKernel, OfDegenerateShapesIsFiniteOrNowhere) {
  const glm::dvec3 d{0.1, 0.2, 1};
  const auto seen = [&](const glm::dvec3& o, const glm::dmat3& factor, double prefilter) {
    return RayKernel(o, factor, kRayEta, prefilter).on_ray(d);
  };
  EXPECT_FALSE(seen({0, 0, 1}, glm::dmat3(0), 0).r2 <= 9) << "a point without a prefilter";
  EXPECT_TRUE(std::isfinite(seen({0.1, 0.2, 1}, glm::dmat3(0), 1).r2)) << "a point";
  EXPECT_EQ(seen({0.1, 0.2, 1}, glm::dmat3(0), 1).gain, 0) << "a point";
  EXPECT_FALSE(seen({0, 0, 0}, glm::dmat3(0), 1).r2 <= 9) << "a point at the eye";
  EXPECT_FALSE(seen({std::nan(""), 0, 1}, glm::dmat3(0.1), 1).r2 <= 9) << "not a number";
  const glm::dvec3 along = glm::normalize(d);
  const glm::dmat3 line{along, glm::dvec3(0), glm::dvec3(0)};
  EXPECT_TRUE(std::isfinite(seen(3.0 * along, line, 1).depth)) << "a line towards the eye";
}

/// One white kernel with the given optical depth at its centre, against exact rays, 128 x 128 pixels, dB.
struct OneKernel {
  double exact = 0;
  double affine = 0;
};
OneKernel one_kernel(const glm::dvec3& o, const glm::dmat3& factor, double eta, const glm::dvec2& centre) {
  constexpr int kPictureSide = 128;
  const auto ray = [&](const glm::dvec2& pixel) {
    const glm::dvec2 at = (pixel - 0.5 * kPictureSide) / eta;
    return glm::dvec3(centre.x + at.x, centre.y - at.y, 1);
  };
  const RayKernel sharp(o, factor, eta, 0);
  const RayKernel exact(o, factor, eta, 1);
  const double peak = 1.5 / sharp.on_ray({centre, 1}).length;
  const auto light = [&](double length) { return glm::dvec4(1 - std::exp(-peak * length)); };
  const auto before_eye = [](const KernelOnRay& seen) { return seen.length * share_between(seen, 0, 1e9); };
  const LightPicture ideal = prefiltered_picture(kPictureSide, kPictureSide, 3, [&](const glm::dvec2& pixel) {
    return light(before_eye(sharp.on_ray(ray(pixel))));
  });
  const auto against_ideal = [&](const LightSampler& sample) {
    return covered_psnr(sampled_picture(kPictureSide, kPictureSide, sample), ideal);
  };
  OneKernel errors;
  errors.exact = against_ideal([&](const auto& pixel) { return light(before_eye(exact.on_ray(ray(pixel)))); });
  if (o.z <= 0) return errors;
  const AffineKernel affine(o, factor, eta, 1);
  errors.affine = against_ideal([&](const auto& pixel) { return light(affine.length(ray(pixel))); });
  return errors;
}

TEST(RayKernel, DrawsAloneWhatExactRaysDoWhereTheAffineFormDoesNot) {
  constexpr double kDegree = 0.017453292519943295;
  const auto towards = [](const glm::dvec3& deviations, double degrees) {
    return rotated(deviations, {0, 1, 0}, degrees * kDegree);
  };
  const OneKernel round = one_kernel({0, 0, 4}, glm::dmat3(0.1), 480, {0, 0});  // 12 px
  EXPECT_GT(round.exact, 55);
  EXPECT_GT(round.affine, 45);
  const OneKernel corner = one_kernel({5, 5, 4}, glm::dmat3(0.6), 60, {1.25, 1.25});
  EXPECT_GT(corner.exact, 54);
  EXPECT_LT(corner.affine, 30);
  const OneKernel near = one_kernel({0, 0, 4}, glm::dmat3(1), 60, {0, 0});
  EXPECT_GT(near.exact, 58);
  EXPECT_LT(near.affine, 35);
  const OneKernel needle = one_kernel({0.5, 0.3, 4}, towards({0.05, 0.05, 1}, 20), 200, {0.125, 0.075});
  EXPECT_GT(needle.exact, 37);
  EXPECT_LT(needle.affine, 25);
  const OneKernel edge_on = one_kernel({0.5, 0.3, 4}, towards({0.05, 1, 1}, 0), 100, {0.125, 0.075});
  EXPECT_GT(edge_on.exact, 38);
  EXPECT_LT(edge_on.affine, 25);
  EXPECT_GT(one_kernel({0.3, 0.2, 0}, glm::dmat3(0.4), 100, {0.4, 0.3}).exact, 65) << "astride the eye's plane";
  EXPECT_GT(one_kernel({0.1, 0.1, 0.2}, glm::dmat3(0.4), 100, {0, 0}).exact, 65) << "eye within";
}

}  // namespace
}  // namespace surfcast::reference
