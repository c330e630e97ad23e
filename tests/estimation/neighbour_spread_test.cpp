#include "estimation/neighbour_spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::estimation {
namespace {

/// Three perpendicular unit vectors.
using Axes = std::array<glm::dvec3, 3>;

Axes random_axes(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] { return glm::dvec3(normal(random), normal(random), normal(random)); };
  const glm::dvec3 a = glm::normalize(vector());
  const glm::dvec3 b = glm::normalize(glm::cross(a, vector()));
  return {a, b, glm::cross(a, b)};
}

/// The matrix with these eigenvalues, ascending, and eigenvectors.
Covariance matrix_of(const glm::dvec3& values, const Axes& axes) {
  Covariance m;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3& v = axes[static_cast<size_t>(i)];
    m.diagonal += values[i] * v * v;
    m.mixed += values[i] * glm::dvec3(v.y * v.z, v.z * v.x, v.x * v.y);
  }
  return m;
}

/// Surfaces, volumes, lines, and two or three values that are equal, or nearly.
const std::vector<glm::dvec3> kValues = {
    {0.1, 0.3, 0.6}, {0, 0.4, 0.6},   {1e-9, 0.5, 0.5 - 1e-9}, {0.3, 0.33, 0.37},        {1e-4, 2e-4, 1 - 3e-4},
    {0.2, 0.2, 0.6}, {0.2, 0.4, 0.4}, {0.333, 0.3335, 0.3335}, {1. / 3, 1. / 3, 1. / 3}, {1e-12, 1e-12, 1.0},
    {0, 0, 1}};

TEST(NeighbourSpreadTest, EigenvaluesAreThoseThatTheMatrixIsMadeOf) {
  std::mt19937 random(1);
  for (const glm::dvec3& values : kValues) {
    for (int i = 0; i < 50; ++i) {
      const Spread spread = spread_of(matrix_of(values, random_axes(random)));
      // Equal eigenvalues are sensitive: rounding moves them apart by the root of the precision.
      EXPECT_NEAR(spread.least, values[0], 1e-7);
      EXPECT_NEAR(spread.middle, values[1], 1e-7);
      EXPECT_NEAR(spread.largest, values[2], 1e-7);
      EXPECT_NEAR(spread.least + spread.middle + spread.largest, values[0] + values[1] + values[2], 1e-7);
    }
  }
  const Spread distinct = spread_of(matrix_of({0.1, 0.3, 0.6}, random_axes(random)));
  EXPECT_NEAR(distinct.least, 0.1, 1e-14);
  EXPECT_NEAR(distinct.middle, 0.3, 1e-14);
  EXPECT_NEAR(distinct.largest, 0.6, 1e-14);
}

TEST(NeighbourSpreadTest, TheLeastAxisIsAnEigenvectorEvenOfALineOrAVolume) {
  std::mt19937 random(2);
  for (const glm::dvec3& values : kValues) {
    for (int i = 0; i < 50; ++i) {
      const Axes axes = random_axes(random);
      const Covariance m = matrix_of(values, axes);
      const glm::dvec3 axis = least_axis(m, spread_of(m).least);
      EXPECT_NEAR(glm::length(axis), 1, 1e-12);
      double variance = 0;
      for (int k = 0; k < 3; ++k) {
        const double share = glm::dot(axis, axes[static_cast<size_t>(k)]);
        variance += values[k] * share * share;
      }
      EXPECT_NEAR(variance, values[0], 1e-7) << "the variance along the axis";
    }
  }
}

TEST(NeighbourSpreadTest, CovariancesAreThoseOfTheNearestTwelveAndOfAllNeighbours) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(0.4, 0.6);
  Sites sites;
  std::vector<uint32_t> neighbours;
  for (uint32_t i = 0; i < 33; ++i) sites.positions.emplace_back(at(random), at(random), 0.5 + 0.1 * at(random));
  for (uint32_t i = 1; i < 33; ++i) neighbours.push_back(i);
  for (const size_t count : {1U, 5U, 12U, 13U, 32U}) {
    const Covariances found = covariances_of(NeighbourOffsets(sites, 0, std::span(neighbours).first(count)));
    for (const auto& [used, covariance] : {std::pair(std::min<size_t>(count, 12), found.near), {count, found.wide}}) {
      glm::dvec3 mean(0);
      for (size_t i = 0; i <= used; ++i) mean += sites.positions[i] / static_cast<double>(used + 1);
      Covariance expected;
      for (size_t i = 0; i <= used; ++i) {
        const glm::dvec3 d = sites.positions[i] - mean;
        expected.diagonal += d * d;
        expected.mixed += glm::dvec3(d.y * d.z, d.z * d.x, d.x * d.y);
      }
      const double trace = expected.diagonal.x + expected.diagonal.y + expected.diagonal.z;
      EXPECT_LT(glm::distance(covariance.diagonal, expected.diagonal / trace), 1e-13) << count;
      EXPECT_LT(glm::distance(covariance.mixed, expected.mixed / trace), 1e-13) << count;
    }
  }
}

}  // namespace
}  // namespace surfcast::estimation
