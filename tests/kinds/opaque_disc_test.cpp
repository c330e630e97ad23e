#include "kinds/opaque_disc.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include <gtest/gtest.h>

#include "reference/resampling_filter.h"

namespace surfcast::kinds {
namespace {

constexpr double kEta = 1300;

// The reference renderer has its own implementation of the disc.
TEST(OpaqueDisc, CoversThePixelsThatTheReferenceCoversAtTheSameDepths) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> even(-1, 1);
  int covered = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 ray(0.4 * even(random), 0.3 * even(random), 1);
    const double depth = std::exp(4 * even(random));
    const double radius = 0.3 * depth * std::exp(3 * even(random) - 3);
    const glm::dvec3 n = glm::normalize(glm::dvec3(even(random), even(random), even(random)));
    const glm::dvec3 o = ray * depth + radius * glm::dvec3(even(random), even(random), even(random));
    const auto splat = reference::Splat::make(o, n, radius, kEta, 1, {});
    const auto hit = hit_disc(o, n, radius, ray, kEta);
    ASSERT_EQ(hit.has_value(), splat.has_value() && splat->opaque(ray)) << i;
    if (!hit) continue;
    ++covered;
    EXPECT_NEAR(hit->depth, splat->fragment_depth(ray), 1e-9 * depth);
    EXPECT_NEAR(hit->occluder, splat->disc_depth(ray).pushed, 1e-9 * depth);
  }
  EXPECT_GT(covered, 5000);
}

TEST(OpaqueDisc, ATinyDiscCoversThePixelThatItsCentreIsIn) {
  EXPECT_TRUE(hit_disc({0, 0, 10}, {0, 0, -1}, 1e-9, {0.4 / kEta, 0.4 / kEta, 1}, kEta));
  EXPECT_FALSE(hit_disc({0, 0, 10}, {0, 0, -1}, 1e-9, {0.7 / kEta, 0, 1}, kEta));
}

TEST(OpaqueDisc, WhatIsBehindTheEyeIsNotHit) {
  EXPECT_FALSE(hit_disc({0, 0, -10}, {0, 0, 1}, 1, {0, 0, 1}, kEta));
  EXPECT_FALSE(hit_disc({0, 0, -0.5}, {0, 0, 1}, 1, {0, 0, 1}, kEta));
}

TEST(OpaqueDisc, EdgeOnItIsAsThinAsThePrefilterAndNeverBeyondItsOwnDepth) {
  const glm::dvec3 o(0, 0, 10);
  const auto hit = hit_disc(o, {0, 1, 0}, 1, {0, 0.3 / kEta, 1}, kEta);
  ASSERT_TRUE(hit);
  EXPECT_LE(hit->depth, 10 + 1.2);
  EXPECT_FALSE(hit_disc(o, {0, 1, 0}, 1, {0, 2 / kEta, 1}, kEta));
}

}  // namespace
}  // namespace surfcast::kinds
