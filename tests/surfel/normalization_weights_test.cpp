#include "surfel/normalization_weights.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/geometric.hpp>
#include <random>

#include <gtest/gtest.h>

#include "shared/kernel.h"
#include "surfel/even_sampling.h"

namespace surfcast::surfel {
namespace {

void add_surfel(SurfelCloud& cloud, const glm::dvec3& position, double radius = 1,
                const glm::vec3& normal = {0, 0, 1}) {
  cloud.positions.push_back(position);
  cloud.normals.push_back(normal);
  cloud.radii.push_back(static_cast<float>(radius));
}

double kernel(double distance, double radius) {
  const double squared = std::pow(distance / (SURFCAST_KERNEL_SIGMA * radius), 2);
  return squared <= SURFCAST_KERNEL_CUTOFF ? std::exp(-0.5 * squared) : 0;
}

/// Surfels at i * a + j * b for |i|, |j| <= half; the one in the middle of the list is at the origin.
SurfelCloud lattice_cloud(const glm::dvec3& a, const glm::dvec3& b, int half, double radius) {
  SurfelCloud cloud;
  for (int i = -half; i <= half; ++i) {
    for (int j = -half; j <= half; ++j) add_surfel(cloud, double(i) * a + double(j) * b, radius);
  }
  return cloud;
}

double lattice_sum(const SurfelCloud& cloud, const glm::dvec3& at) {
  double sum = 0;
  for (size_t i = 0; i < cloud.size(); ++i) sum += kernel(glm::length(cloud.positions[i] - at), double{cloud.radii[i]});
  return sum;
}

TEST(NormalizationWeights, OfAnIsolatedSurfelIsOne) {
  SurfelCloud cloud;
  add_surfel(cloud, {5e6, -3, 2});
  add_surfel(cloud, {5e6 + 100, -3, 2});
  EXPECT_EQ(normalization_weights(cloud), (std::vector<float>{1, 1}));
}

TEST(NormalizationWeights, OnASquareLatticeAreTheReciprocalOfASquaredThetaFunction) {
  // Wide kernels: radius 3 spacings.
  const double radius = 3;
  const SurfelCloud cloud = lattice_cloud({1, 0, 0}, {0, 1, 0}, 8, radius);
  const std::vector<float> weights = normalization_weights(cloud);
  const float middle = weights[weights.size() / 2];
  EXPECT_NEAR(middle, 1 / lattice_sum(cloud, {0, 0, 0}), 1e-6);

  // Without cutoff the sum is theta(q)^2 with q = exp(-1 / (2 sigma^2)) and theta = 1 + 2 q + 2 q^4 + 2 q^9 ...; the
  // cutoff c leaves out exp(-c / 2) of it, give or take the lattice points that lie right at the edge.
  const double sigma = SURFCAST_KERNEL_SIGMA * radius;
  double theta = 1;
  for (int i = 1; i < 50; ++i) theta += 2 * std::exp(-0.5 * i * i / (sigma * sigma));
  EXPECT_NEAR(middle * theta * theta, 1, 3 * std::exp(-0.5 * SURFCAST_KERNEL_CUTOFF));
}

TEST(NormalizationWeights, OnAHexagonalLatticeAreTheReciprocalOfItsSum) {
  const SurfelCloud cloud = lattice_cloud({1, 0, 0}, {0.5, std::sqrt(0.75), 0}, 8, 2.2);
  const std::vector<float> weights = normalization_weights(cloud);
  EXPECT_NEAR(weights[weights.size() / 2], 1 / lattice_sum(cloud, {0, 0, 0}), 1e-6);
}

TEST(NormalizationWeights, GrowTowardsAnEdge) {
  const SurfelCloud cloud = lattice_cloud({1, 0, 0}, {0, 1, 0}, 8, 2);
  const std::vector<float> weights = normalization_weights(cloud);
  const float corner = weights.front();
  const float edge = weights[8];
  const float middle = weights[weights.size() / 2];
  EXPECT_NEAR(edge, 1 / lattice_sum(cloud, {-8, 0, 0}), 1e-6);
  EXPECT_NEAR(corner, 1 / lattice_sum(cloud, {-8, -8, 0}), 1e-6);
  EXPECT_GT(edge, middle);
  EXPECT_GT(corner, edge);
}

TEST(NormalizationWeights, OfCoincidentSurfelsShareOne) {
  for (const size_t count : {2u, 3u, 1000u}) {
    SurfelCloud cloud;
    for (size_t i = 0; i < count; ++i) add_surfel(cloud, {1, 2, 3});
    for (const float weight : normalization_weights(cloud)) {
      ASSERT_FLOAT_EQ(weight, 1 / static_cast<float>(count));
    }
  }
}

/// CPU seconds, which do not depend on what else the machine does, to weigh that many coincident surfels.
double seconds_to_weigh_coincident(size_t count) {
  SurfelCloud cloud;
  for (size_t i = 0; i < count; ++i) add_surfel(cloud, {1, 2, 3});
  const std::clock_t start = std::clock();
  const std::vector<float> weights = normalization_weights(cloud);
  const std::clock_t end = std::clock();
  for (const float weight : weights) EXPECT_NEAR(weight * static_cast<float>(count), 1, 0.01);
  return static_cast<double>(end - start) / CLOCKS_PER_SEC;
}

TEST(NormalizationWeights, OfVeryManyCoincidentSurfelsTakeNoQuadraticTime) {
  const double once = seconds_to_weigh_coincident(20000);
  const double fourfold = seconds_to_weigh_coincident(80000);
  EXPECT_LT(fourfold / once, 10) << "4 would be linear, 16 quadratic";
}

TEST(NormalizationWeights, OfFarTooLargeRadiiAreSampledWithinAFewPercent) {
  SurfelCloud cloud;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 30000; ++i) add_surfel(cloud, {uniform(random), uniform(random), 0}, 0.5 + 0.4 * uniform(random));
  const std::vector<float> weights = normalization_weights(cloud);
  for (size_t k = 0; k < cloud.size(); k += 997) {
    EXPECT_NEAR(weights[k] * lattice_sum(cloud, cloud.positions[k]), 1, 0.05);
  }
}

TEST(NormalizationWeights, CountASmallSurfelUnderALargeOneAndNotTheReverse) {
  SurfelCloud cloud;
  add_surfel(cloud, {0, 0, 0}, 100);
  add_surfel(cloud, {30, 0, 0}, 0.01);
  const std::vector<float> weights = normalization_weights(cloud);
  EXPECT_EQ(weights[0], 1);
  EXPECT_NEAR(weights[1], 1 / (1 + kernel(30, 100)), 1e-6);
}

TEST(NormalizationWeights, OfCrossingSheetsDoNotMix) {
  SurfelCloud crossing = lattice_cloud({1, 0, 0}, {0, 1, 0}, 6, 2);
  const std::vector<float> alone = normalization_weights(crossing);
  const size_t sheet = crossing.size();
  for (int i = -6; i <= 6; ++i) {
    for (int j = -6; j <= 6; ++j) add_surfel(crossing, {0.5, i, j}, 2, {1, 0, 0});
  }
  const std::vector<float> both = normalization_weights(crossing);
  for (size_t i = 0; i < sheet; ++i) EXPECT_EQ(both[i], alone[i]);
}

TEST(NormalizationWeights, OfTheTwoSidesOfAThinSheetMixOnlyWithoutOrientation) {
  SurfelCloud cloud;
  add_surfel(cloud, {0, 0, 0}, 1, {0, 0, 1});
  add_surfel(cloud, {0, 0, -0.25}, 1, {0, 0, -1});
  EXPECT_EQ(normalization_weights(cloud), (std::vector<float>{0.5f, 0.5f}));
  cloud.oriented = true;
  EXPECT_EQ(normalization_weights(cloud), (std::vector<float>{1, 1}));
}

TEST(NormalizationWeights, OfASheetARadiusBelowAreItsOwn) {
  SurfelCloud cloud;
  add_surfel(cloud, {0, 0, 0}, 1);
  add_surfel(cloud, {0, 0, -1.5}, 1);
  EXPECT_EQ(normalization_weights(cloud), (std::vector<float>{1, 1}));
}

TEST(NormalizationWeights, DoNotChangeWithTheScaleOrThePlaceOfTheModel) {
  const SurfelCloud cloud = lattice_cloud({1, 0.25, 0}, {0, 1, 0}, 6, 2);
  const std::vector<float> expected = normalization_weights(cloud);
  for (const double scale : {std::ldexp(1.0, -13), std::ldexp(1.0, 17)}) {
    SurfelCloud scaled = cloud;
    for (glm::dvec3& p : scaled.positions) p = (p + glm::dvec3(4194304, -1024, 7)) * scale;
    for (float& r : scaled.radii) r *= static_cast<float>(scale);
    EXPECT_EQ(normalization_weights(scaled), expected);
  }
}

TEST(NormalizationWeights, ScatterNeitherHasNorIsANeighbour) {
  SurfelCloud cloud;
  for (int i = 0; i < 400; ++i) add_surfel(cloud, {i % 20, i / 20, 0}, 1.1);
  const std::vector<float> without = normalization_weights(cloud);
  SurfelCloud more = cloud;
  for (int i = 0; i < 50; ++i) add_surfel(more, {10 + 0.01 * i, 10, 0.01 * i});
  more.scatter.assign(more.size(), 0);
  std::fill(more.scatter.begin() + 400, more.scatter.end(), 1);
  const std::vector<float> with = normalization_weights(more);
  EXPECT_TRUE(std::equal(without.begin(), without.end(), with.begin()));
  for (size_t i = 400; i < with.size(); ++i) {
    // Under either normalisation the same.
    EXPECT_NEAR(double{with[i]} * per_surfel_scale(SURFCAST_KERNEL_SIGMA), even_sampling_weight(SURFCAST_KERNEL_SIGMA),
                1e-6);
  }
}

}  // namespace
}  // namespace surfcast::surfel
