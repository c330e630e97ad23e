#include "model/quantize.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::model {
namespace {

double error_of(const glm::dvec3& normal, int half = kSourcePrecision.octahedral_half) {
  const glm::dvec3 back(decode_normal(encode_normal(glm::vec3(normal), half), half));
  return std::atan2(glm::length(glm::cross(normal, back)), glm::dot(normal, back)) * 180 / std::numbers::pi;
}

TEST(Quantize, NormalsComeBackWithinATenthOfADegree) {
  std::mt19937 random(1);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 200000; ++i) {
    ASSERT_LT(error_of(glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)))), 0.1);
  }
}

TEST(Quantize, EstimatedNormalsComeBackWithinADegree) {
  std::mt19937 random(1);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 200000; ++i) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
    ASSERT_LT(error_of(normal, kEstimatePrecision.octahedral_half), 1);
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
  for (const int half : {kSourcePrecision.octahedral_half, kEstimatePrecision.octahedral_half}) {
    for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
      EXPECT_EQ(decode_normal(encode_normal(axis, half), half), axis);
      EXPECT_EQ(decode_normal(encode_normal(-axis, half), half), -axis);
    }
  }
}

TEST(Quantize, EveryNormalCodeIsAUnitVectorThatKeepsItsDirection) {
  constexpr int kHalf = kSourcePrecision.octahedral_half;
  for (int u = 0; u <= 2 * kHalf; u += 13) {
    for (int v = 0; v <= 2 * kHalf; v += 13) {
      const glm::vec3 n = decode_normal(glm::u16vec2(u, v), kHalf);
      ASSERT_NEAR(glm::length(n), 1, 1e-6);
      ASSERT_GT(glm::dot(decode_normal(encode_normal(n, kHalf), kHalf), n), 1 - 1e-6);
    }
  }
}

/// Relative error of a value after encoding and decoding.
double relative_error(float value, int steps) {
  return std::abs(decode_logarithm(encode_logarithm(value, steps), steps) / double{value} - 1);
}

TEST(Quantize, LogarithmsOfEverySizeComeBackWithinHalfAStep) {
  using Limits = std::numeric_limits<float>;
  for (const float value : {Limits::min(), 1e-30f, 0.001f, 1.0f, 3.14159f, 1e30f, 3.4e38f}) {
    EXPECT_LT(relative_error(value, kSourcePrecision.radius_steps), std::exp2(-11.5)) << value;
    EXPECT_LT(relative_error(value, kEstimatePrecision.radius_steps), 0.022) << value;
    EXPECT_LT(relative_error(value, kWeightSteps), 0.011) << value;
  }
}

TEST(Quantize, TheSmallestAndLargestFloatsStayPositiveAndFinite) {
  using Limits = std::numeric_limits<float>;
  for (const Precision& precision : {kSourcePrecision, kEstimatePrecision}) {
    const int steps = precision.radius_steps;
    EXPECT_GT(decode_logarithm(encode_logarithm(Limits::denorm_min(), steps), steps), 0);
    EXPECT_TRUE(std::isfinite(decode_logarithm(encode_logarithm(Limits::max(), steps), steps)));
    EXPECT_GT(decode_logarithm(0, steps), 0);
    EXPECT_TRUE(std::isfinite(decode_logarithm(precision.max_radius_code(), steps)));
    EXPECT_LE(encode_logarithm(Limits::max(), steps), precision.max_radius_code());
  }
}

TEST(Quantize, PowersOfTwoComeBackExactly) {
  for (int exponent = -100; exponent <= 100; exponent += 10) {
    EXPECT_EQ(relative_error(std::ldexp(1.0f, exponent), kSourcePrecision.radius_steps), 0);
    EXPECT_EQ(relative_error(std::ldexp(1.0f, exponent), kWeightSteps), 0);
  }
}

}  // namespace
}  // namespace surfcast::model
