#include "reference/volume_grid.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "reference/transfer_function.h"
#include "reference/volume_field.h"

namespace surfcast::reference {
namespace {

constexpr double kSigma = 0.6;

TEST(VolumeGrid, TapsOfAKernelSumToOne) {
  double sum = 0;
  for (int m = -4; m <= 4; ++m) sum += tap(m, kSigma);
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_NEAR(tap(1, kSigma) / tap(0, kSigma), std::exp(-0.5 / 0.36), 1e-12);
}

TEST(VolumeGrid, KernelsArePartitionOfUnityWithinTwoThousandths) {
  const VolumeGrid ones = make_grid({12, 12, 12}, glm::dvec3(0), glm::dmat3(1), [](const auto&) { return 1.0; });
  for (int column = 0; column <= 8; ++column) {
    const double x = 5 + 0.125 * column;
    for (int row = 0; row <= 8; ++row) EXPECT_NEAR(gaussian_sum(ones, kSigma, {x, 5 + 0.125 * row, 5.3}), 1, 0.0045);
    EXPECT_NEAR(gaussian_sum(ones, kSigma, {x, 5.25, 5.25}), 1, 0.002);
  }
}

// The residual of every correction is multiplied by 1 - g, g the response of the taps to the wave.
TEST(VolumeGrid, CorrectedTwiceRespondsToWavesByTheCubeOfWhatOneKernelLacks) {
  for (const double cycles : {0.05, 0.2, 0.35, 0.5}) {
    const double omega = 2 * std::numbers::pi * cycles;
    const VolumeGrid wave = make_grid({81, 1, 1}, glm::dvec3(0), glm::dmat3(1),
                                      [&](const auto& p) { return std::cos(omega * (p.x - 40)); });
    const VolumeGrid kernels = corrected(wave, kSigma, 2);
    double drawn = 0;
    double response = 0;
    for (int m = -4; m <= 4; ++m) {
      drawn += tap(m, kSigma) * kernels.at({40 + m, 0, 0});
      response += tap(m, kSigma) * std::cos(omega * m);
    }
    EXPECT_NEAR(drawn, 1 - std::pow(1 - response, 3), 1e-9) << cycles;
    EXPECT_LE(drawn, 1 + 1e-12);
  }
}

TEST(VolumeGrid, CorrectionLeavesAConstantAlone) {
  const VolumeGrid flat = make_grid({5, 1, 7}, glm::dvec3(0), glm::dmat3(1), [](const auto&) { return 0.7; });
  for (const double value : corrected(flat, kSigma, 2).values) EXPECT_NEAR(value, 0.7, 1e-14);
}

TEST(VolumeGrid, InterpolatesPolynomialsOfItsDegree) {
  const auto line = [](const glm::dvec3& p) { return 1 + 2 * p.x - p.y + 0.5 * p.z; };
  const auto parabola = [&](const glm::dvec3& p) { return line(p) + p.x * p.x - 3 * p.y * p.z; };
  const VolumeGrid lines = make_grid({8, 8, 8}, glm::dvec3(0), glm::dmat3(1), line);
  const VolumeGrid parabolas = make_grid({8, 8, 8}, glm::dvec3(0), glm::dmat3(1), parabola);
  const glm::dvec3 p{3.3, 4.8, 2.1};
  EXPECT_NEAR(trilinear(lines, p), line(p), 1e-12);
  EXPECT_NEAR(catmull_rom(parabolas, p), parabola(p), 1e-12);
}

TEST(VolumeGrid, HasGradientsInWorldAxesThoughItsOwnAreSheared) {
  const glm::dvec3 slope{1, -2, 0.5};
  const glm::dmat3 axes{{0.5, 0, 0}, {0.2, 0.4, 0}, {0.1, -0.3, -0.8}};
  const VolumeGrid grid = make_grid({5, 5, 5}, {3, 2, 1}, axes, [&](const auto& p) { return glm::dot(slope, p); });
  const glm::dvec3 found = sample_gradients(grid)[2 * 25 + 2 * 5 + 2];
  EXPECT_LT(glm::distance(found, slope), 1e-12);
}

TEST(VolumeGrid, SpacingAlongADirectionIsThatOfItsAxes) {
  const VolumeGrid grid =
      make_grid({2, 2, 2}, {0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 3}}, [](const auto&) { return 0.0; });
  EXPECT_NEAR(grid.spacing_along({1, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(grid.spacing_along({0, 0, -1}), 3, 1e-12);
}

TEST(VolumeGrid, OfACoarserLevelKeepsPlacesMeansAndFaces) {
  const auto line = [](const glm::dvec3& p) { return 2 * p.x - p.y + 0.5 * p.z; };
  const VolumeGrid fine = make_grid({9, 8, 1}, {1, 2, 3}, glm::dmat3(0.5), line);
  const VolumeGrid coarse = halved(fine);
  EXPECT_EQ(coarse.size, glm::ivec3(5, 4, 1));
  EXPECT_NEAR(coarse.at({2, 1, 0}), line(coarse.place({2, 1, -0.25})), 1e-12) << "z is repeated beyond its only sample";
  EXPECT_LT(glm::distance(coarse.place(coarse.low), fine.place(fine.low)), 1e-12);
  EXPECT_LT(glm::distance(coarse.place(coarse.high), fine.place(fine.high)), 1e-12);
}

TEST(VolumeGrid, ReconstructsMarschnerAndLobbsSignalBestWhenCorrected) {
  const VolumeField field = marschner_lobb();
  const VolumeGrid grid = sampled(field, glm::ivec3(41));
  const VolumeGrid plain = grid;
  const VolumeGrid twice = corrected(grid, kSigma, 2);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  glm::dvec3 squares(0);
  constexpr int kPlaces = 4000;
  for (int i = 0; i < kPlaces; ++i) {
    const glm::dvec3 p{uniform(random), uniform(random), uniform(random)};
    const glm::dvec3 index = 20.0 * (p + 1.0);
    const double exact = field.value(p);
    const glm::dvec3 error{trilinear(grid, index) - exact, gaussian_sum(plain, kSigma, index) - exact,
                           gaussian_sum(twice, kSigma, index) - exact};
    squares += error * error;
  }
  const auto decibels = [&](double sum) { return -10 * std::log10(sum / kPlaces); };
  EXPECT_NEAR(decibels(squares.x), 31.8, 0.7);
  EXPECT_NEAR(decibels(squares.y), 28.3, 0.7);
  EXPECT_NEAR(decibels(squares.z), 34.3, 0.7);
}

TEST(TransferFunction, IsLinearBetweenPointsAndConstantBeyond) {
  const TransferFunction transfer({{1, {1, 1, 1}, 0.5}, {0, {0, 0, 0}, 0}}, 2);
  EXPECT_EQ(transfer.at(-5).extinction, 0);
  EXPECT_NEAR(transfer.at(0.5).extinction, -0.5 * std::log(0.5) / 2, 1e-12) << "half of that at 1";
  EXPECT_NEAR(transfer.at(0.5).color.x, 0.5, 1e-12);
  EXPECT_NEAR(transfer.at(7).extinction, -std::log(0.5) / 2, 1e-12);
}

TEST(TransferFunction, MeansAreIntegralsOverTheirRange) {
  const TransferFunction transfer(
      {{0, {1, 0, 0}, 0}, {0.2, {0, 1, 0}, 0.3}, {0.4, {0, 0, 1}, 0.1}, {0.4, {1, 1, 0}, 0.6}, {1, {0.2, 0.4, 1}, 0}},
      2);
  for (const auto& [a, b] : {std::pair(0.05, 0.15), std::pair(0.1, 0.9), std::pair(1.5, -0.5), std::pair(0.4, 0.2)}) {
    Classified sum;
    constexpr int kSteps = 100'000;
    for (int i = 0; i < kSteps; ++i) {
      const Classified seen = transfer.at(std::lerp(a, b, (i + 0.5) / kSteps));
      sum.extinction += seen.extinction / kSteps;
      sum.color += seen.extinction / kSteps * seen.color;
    }
    const Classified mean = transfer.mean(a, b);
    EXPECT_NEAR(mean.extinction, sum.extinction, 1e-5) << a << " to " << b;
    EXPECT_LT(glm::distance(mean.color, sum.color / sum.extinction), 1e-4) << a << " to " << b;
  }
  EXPECT_EQ(transfer.mean(0.3, 0.3).extinction, transfer.at(0.3).extinction);
  EXPECT_EQ(transfer.mean(2, 3).extinction, 0);
}

TEST(TransferFunction, MayBeEmptyOnePointOrAStep) {
  EXPECT_EQ(TransferFunction({}, 1).at(0.5).extinction, 0);
  EXPECT_FALSE(TransferFunction({}, 1).visible_within(-1e9, 1e9));
  EXPECT_GT(TransferFunction({{0.3, {1, 1, 1}, 1}}, 1).at(-9).extinction, 0);
  EXPECT_TRUE(std::isfinite(TransferFunction({{0.3, {1, 1, 1}, 1}}, 1).at(0).extinction)) << "opacity 1";
  const TransferFunction step({{0.5, {1, 1, 1}, 0}, {0.5, {1, 1, 1}, 0.2}}, 1);
  EXPECT_EQ(step.at(0.499999).extinction, 0);
  EXPECT_GT(step.at(0.5).extinction, 0);
}

TEST(TransferFunction, ShowsWhatLiesBetweenTwoValues) {
  const TransferFunction peak({{0.4, {1, 1, 1}, 0}, {0.5, {1, 1, 1}, 0.2}, {0.6, {1, 1, 1}, 0}}, 1);
  EXPECT_FALSE(peak.visible_within(0, 0.4));
  EXPECT_TRUE(peak.visible_within(0, 1)) << "clear at both ends";
  EXPECT_TRUE(peak.visible_within(0.55, 0.58));
  EXPECT_FALSE(peak.visible_within(0.6, 2));
}

TEST(RayLight, OfTwoHalvesIsThatOfTheWhole) {
  RayLight whole;
  whole.add({1, 0.5, 0}, 0.7, 2);
  RayLight halves;
  for (int i = 0; i < 2; ++i) halves.add({1, 0.5, 0}, 0.7, 1);
  EXPECT_NEAR(whole.transmittance, std::exp(-1.4), 1e-12);
  EXPECT_NEAR(whole.transmittance, halves.transmittance, 1e-12);
  EXPECT_LT(glm::distance(whole.light, halves.light), 1e-12);
}

}  // namespace
}  // namespace surfcast::reference
