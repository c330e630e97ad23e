#include "exporter/even_sample.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::exporter {
namespace {

/// Random points of a slanted plane through the cube.
std::vector<SamplePoint> plane(size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> number(0, 1);
  std::vector<SamplePoint> points(count);
  for (SamplePoint& point : points) {
    const float u = number(random), v = number(random);
    point = {{u, v, 0.25F + 0.3F * u + 0.2F * v}, random()};
  }
  return points;
}

float nearest(const std::vector<SamplePoint>& points, const std::vector<uint32_t>& sample, size_t to) {
  float least = 9;
  for (const uint32_t i : sample) {
    if (i != to) least = std::min(least, glm::distance(points[i].place, points[to].place));
  }
  return least;
}

TEST(EvenSampleTest, PointsKeepTheirDistanceAndNoPlaceIsLeftOut) {
  const std::vector<SamplePoint> points = plane(30000);
  const std::vector<uint32_t> sample = even_sample(points);
  ASSERT_TRUE(std::ranges::is_sorted(sample));
  ASSERT_GT(sample.size(), 5000U);
  double sum = 0, squares = 0;
  for (size_t k = 0; k < sample.size(); k += 8) {
    const double distance = nearest(points, sample, sample[k]) / kSampleSpacing;
    ASSERT_GE(distance, 1 - 1e-6);
    sum += distance;
    squares += distance * distance;
  }
  for (size_t i = 0; i < points.size(); i += 97) {
    if (std::ranges::binary_search(sample, i)) continue;
    EXPECT_LT(nearest(points, sample, i), kSampleSpacing);
  }
  // Distances of random places vary by half of their mean, those of one random point for each cell by a third.
  const auto count = std::ceil(static_cast<double>(sample.size()) / 8);
  const double mean = sum / count;
  EXPECT_LT(std::sqrt(squares / count - mean * mean) / mean, 0.15);
}

TEST(EvenSampleTest, TheOrderOfThePointsDoesNotMatter) {
  std::vector<SamplePoint> points = plane(5000);
  const auto hashes_of = [&] {
    std::vector<uint64_t> hashes;
    for (const uint32_t i : even_sample(points)) hashes.push_back(points[i].hash);
    std::ranges::sort(hashes);
    return hashes;
  };
  const std::vector<uint64_t> expected = hashes_of();
  std::ranges::reverse(points);
  EXPECT_EQ(hashes_of(), expected);
}

TEST(EvenSampleTest, OfPointsInOnePlaceThatWithTheLeastHashIsTaken) {
  const std::vector<SamplePoint> points = {{{0.5F, 0, 1}, 9}, {{0.5F, 0, 1}, 3}, {{0.5F, 0, 1}, 7}};
  EXPECT_THAT(even_sample(points), ::testing::ElementsAre(1U));
}

TEST(EvenSampleTest, FacesAndCornersOfTheCubeAreInIt) {
  std::vector<SamplePoint> points;
  for (uint32_t corner = 0; corner < 8; ++corner) {
    points.push_back({{corner & 1, corner >> 1 & 1, corner >> 2}, corner});
    points.push_back({glm::vec3(0.999F) * points.back().place + 0.0005F, 100 + corner});  // next to it
  }
  EXPECT_THAT(even_sample(points), ::testing::ElementsAre(0U, 2U, 4U, 6U, 8U, 10U, 12U, 14U));
}

TEST(EvenSampleTest, NoPointsHaveAnEmptySample) {
  EXPECT_THAT(even_sample({}), ::testing::IsEmpty());
}

}  // namespace
}  // namespace surfcast::exporter
