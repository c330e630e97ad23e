// Kernels of scattered samples against closed forms.

#include "scattered/kernel_sample.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <numbers>

#include <gtest/gtest.h>

namespace surfcast::scattered {
namespace {

constexpr double kPi = std::numbers::pi;

/// The integral of 4 pi r^2 times a power of r times the profile, by the rule of Simpson.
double radial_integral(Profile profile, int power) {
  constexpr int kSteps = 20000;
  const double width = reach_of(profile) / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double r = i * width;
    const double at = 4 * kPi * std::pow(r, 2 + power) * profile_at(profile, r * r);
    sum += at * (i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2));
  }
  return sum * width / 3;
}

TEST(KernelSampleTest, ProfilesAreOneAtTheCentreAndEndAtTheirReach) {
  for (const Profile profile : {Profile::kGaussian, Profile::kSpline}) {
    EXPECT_EQ(profile_at(profile, 0), 1);
    EXPECT_EQ(profile_at(profile, reach_of(profile) * reach_of(profile)), 0);
  }
  EXPECT_NEAR(profile_at(Profile::kSpline, 1), 0.25, 1e-15);
  EXPECT_NEAR(profile_at(Profile::kSpline, 2.25), 0.25 * 0.125, 1e-15);
  EXPECT_NEAR(profile_at(Profile::kGaussian, 2), std::exp(-1), 1e-15);
}

TEST(KernelSampleTest, IntegralsAndVariancesAreThoseOfTheProfiles) {
  EXPECT_NEAR(radial_integral(Profile::kSpline, 0), integral_of(Profile::kSpline), 1e-9);
  EXPECT_NEAR(radial_integral(Profile::kGaussian, 0), integral_of(Profile::kGaussian), 1e-2);  // beyond its reach
  const double variance = radial_integral(Profile::kSpline, 2) / radial_integral(Profile::kSpline, 0) / 3;
  EXPECT_NEAR(variance, kSplineVariance, 1e-9);
}

TEST(KernelSampleTest, WideningReachesTheDeviationAndKeepsTheIntegral) {
  for (const Profile profile : {Profile::kGaussian, Profile::kSpline}) {
    KernelSample sample{{}, {4, 0, 0, 9, 0, 16}, 1, 3};
    EXPECT_FALSE(widen(0.9, profile, true, sample));
    EXPECT_EQ(sample.amplitude, 3);
    const double before = sample.amplitude * std::sqrt(glm::determinant(sample.shape.matrix()));
    EXPECT_TRUE(widen(5, profile, true, sample));
    EXPECT_NEAR(least_deviation(sample, profile), 5, 1e-12);
    EXPECT_NEAR(sample.amplitude * std::sqrt(glm::determinant(sample.shape.matrix())), before, 1e-12 * before);
  }
}

TEST(KernelSampleTest, AFlatKernelIsWidenedToNothingOrKeepsItsWeight) {
  KernelSample flat{{}, {1, 0, 0, 1, 0, 0}, 1, 1};
  KernelSample weight = flat;
  EXPECT_EQ(least_deviation(flat, Profile::kGaussian), 0);
  EXPECT_TRUE(widen(0.5, Profile::kGaussian, true, flat));
  EXPECT_EQ(flat.amplitude, 0);
  EXPECT_TRUE(widen(0.5, Profile::kGaussian, false, weight));
  EXPECT_EQ(weight.amplitude, 1);
}

TEST(KernelSampleTest, SizesAreParsed) {
  EXPECT_EQ(parse_kernel_sizes("spacing")->meaning, KernelSize::kSpacing);
  const Result<KernelSizes> column = parse_kernel_sizes("smoothing=hsml");
  ASSERT_TRUE(column);
  EXPECT_EQ(column->meaning, KernelSize::kSmoothingLength);
  EXPECT_EQ(column->column, "hsml");
  EXPECT_EQ(parse_kernel_sizes("radius=0.25")->length, 0.25);
  EXPECT_EQ(parse_kernel_sizes("covariance=c")->column, "c");
  for (const char* wrong : {"", "radius", "radius=", "radius=-1", "sigma=0", "sigma=inf", "covariance=1", "size=h"}) {
    EXPECT_FALSE(parse_kernel_sizes(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace surfcast::scattered
