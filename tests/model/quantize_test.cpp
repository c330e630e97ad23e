#include "model/quantize.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace surfcast {
namespace {

double error_of(const glm::dvec3& normal) {
  const glm::dvec3 back(decode_normal(encode_normal(glm::vec3(normal))));
  return std::atan2(glm::length(glm::cross(normal, back)), glm::dot(normal, back)) * 180 / std::numbers::pi;
}

TEST(Quantize, NormalsComeBackWithinATenthOfADegree) {
  std::mt19937 random(1);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 200000; ++i) {
    ASSERT_LT(error_of(glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)))), 0.1);
  }
}

TEST(Quantize, NormalsNearAxesEdgesAndFoldsComeBackWithinATenthOfADegree) {
  constexpr std::array<double, 9> kValues{-1, -0.5, -1e-4, -1e-9, 0, 1e-9, 1e-4, 0.5, 1};
  for (const double x : kValues) {
    for (const double y : kValues) {
      for (const double z : kValues) {
        if (x != 0 || y != 0 || z != 0) {
          ASSERT_LT(error_of(glm::normalize(glm::dvec3(x, y, z))), 0.1);
        }
      }
    }
  }
}

TEST(Quantize, AxesComeBackExactly) {
  for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
    EXPECT_EQ(decode_normal(encode_normal(axis)), axis);
    EXPECT_EQ(decode_normal(encode_normal(-axis)), -axis);
  }
}

TEST(Quantize, EveryNormalCodeIsAUnitVectorThatKeepsItsDirection) {
  for (int u = 0; u <= 2 * kOctahedralHalf; u += 13) {
    for (int v = 0; v <= 2 * kOctahedralHalf; v += 13) {
      const glm::vec3 n = decode_normal(glm::u16vec2(u, v));
      ASSERT_NEAR(glm::length(n), 1, 1e-6);
      ASSERT_GT(glm::dot(decode_normal(encode_normal(n)), n), 1 - 1e-6);
    }
  }
}

TEST(Quantize, RadiiOfEverySizeComeBackWithinTheirRelativeError) {
  using Limits = std::numeric_limits<float>;
  for (const float radius : {Limits::min(), 1e-30f, 0.001f, 1.0f, 3.14159f, 1e30f, 3.4e38f}) {
    EXPECT_NEAR(decode_radius(encode_radius(radius)) / radius, 1, std::exp2(-11.5)) << radius;
    EXPECT_NEAR(decode_weight(encode_weight(radius)) / radius, 1, 0.00136) << radius;
  }
}

TEST(Quantize, TheSmallestAndLargestFloatsStayPositiveAndFinite) {
  using Limits = std::numeric_limits<float>;
  EXPECT_GT(decode_radius(encode_radius(Limits::denorm_min())), 0);
  EXPECT_TRUE(std::isfinite(decode_radius(encode_radius(Limits::max()))));
  EXPECT_GT(decode_radius(0), 0);
  EXPECT_TRUE(std::isfinite(decode_radius(kMaxRadiusCode)));
  EXPECT_LE(encode_radius(Limits::max()), kMaxRadiusCode);
}

TEST(Quantize, PowersOfTwoComeBackExactly) {
  for (int exponent = -100; exponent <= 100; exponent += 10) {
    const float value = std::ldexp(1.0f, exponent);
    EXPECT_EQ(decode_radius(encode_radius(value)), value);
    EXPECT_EQ(decode_weight(encode_weight(value)), value);
  }
}

}  // namespace
}  // namespace surfcast
