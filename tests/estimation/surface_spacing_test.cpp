#include "estimation/surface_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace surfcast::estimation {
namespace {

const geometry::Box kBounds{{-10, -10, -10}, {10, 10, 10}};

/// A sample at a place of the world.
SurfaceSample sample_at(const glm::dvec3& world, float radius) {
  return {LocalFrame(kBounds).to_local(world), radius};
}

TEST(SurfaceSpacing, IsTheMedianRadiusOfTheEightNearestSamples) {
  std::vector<SurfaceSample> samples;
  for (int i = 1; i <= 8; ++i) samples.push_back(sample_at({0.1 * i, 0, 0}, static_cast<float>(i)));
  for (int i = 0; i < 20; ++i) samples.push_back(sample_at({5 + 0.1 * i, 0, 0}, 100));
  const SurfaceSpacing spacing(samples, kBounds);
  EXPECT_EQ(spacing.at({0, 0, 0}), 5);
  EXPECT_EQ(spacing.at({7, 0, 0}), 100);
}

TEST(SurfaceSpacing, FollowsTheSpacingOfARevolvingScanner) {
  // The radius grows with the distance from the scanner.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> at(-9, 9);
  std::vector<SurfaceSample> samples;
  for (int i = 0; i < 5000; ++i) {
    const double x = at(random);
    const double y = at(random);
    samples.push_back(sample_at({x, y, 0}, static_cast<float>(0.01 + 0.1 * std::hypot(x, y))));
  }
  const SurfaceSpacing spacing(samples, kBounds);
  EXPECT_NEAR(spacing.at({0, 0, 1}), 0.03, 0.03);
  EXPECT_NEAR(spacing.at({6, 6, 1}), 0.86, 0.1);
}

TEST(SurfaceSpacing, DoesNotDependOnTheOrderOfTheSamples) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> at(-5, 5);  // with many equal distances
  std::vector<SurfaceSample> samples;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p(at(random), at(random), at(random));
    samples.push_back(sample_at(p, static_cast<float>(1 + i % 17)));
  }
  const SurfaceSpacing spacing(samples, kBounds);
  std::shuffle(samples.begin(), samples.end(), random);
  const SurfaceSpacing other(samples, kBounds);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p(at(random), at(random), at(random));
    EXPECT_EQ(spacing.at(p), other.at(p));
  }
}

/// The median radius of the eight samples that are nearest by an exhaustive search.
double exhaustive_median(const std::vector<SurfaceSample>& samples, const glm::dvec3& place) {
  const glm::dvec3 local = LocalFrame(kBounds).to_local(place);
  std::vector<std::pair<double, float>> found;
  for (const SurfaceSample& sample : samples) {
    found.emplace_back(glm::distance(local, sample.position), sample.radius);
  }
  std::partial_sort(found.begin(), found.begin() + 8, found.end());
  std::array<float, 8> radii{};
  std::transform(found.begin(), found.begin() + 8, radii.begin(), [](const auto& entry) { return entry.second; });
  std::sort(radii.begin(), radii.end());
  return double{radii[4]};
}

TEST(SurfaceSpacing, AtManyPlacesIsThatOfAnExhaustiveSearchAtEach) {
  std::mt19937 random(3);
  std::normal_distribution<double> near(0, 0.01);  // a dense cluster in sparse surroundings
  std::uniform_real_distribution<double> anywhere(-9, 9);
  std::vector<SurfaceSample> samples;
  std::vector<glm::dvec3> places;
  for (int i = 0; i < 1200; ++i) {
    const bool dense = i % 3 != 0;
    const auto at = [&] { return dense ? 2 + near(random) : anywhere(random); };
    samples.push_back(sample_at({at(), at(), at()}, static_cast<float>(1 + i % 13)));
    places.emplace_back(at(), at(), at());
  }
  std::sort(places.begin(), places.begin() + 600, [](const glm::dvec3& a, const glm::dvec3& b) { return a.x < b.x; });
  const SurfaceSpacing spacing(samples, kBounds);
  const std::vector<float> found = spacing.at_all(places, [](size_t, double) { return false; });
  const std::vector<float> at_least_3 = spacing.at_all(places, [](size_t, double least) { return least >= 3; });
  ASSERT_EQ(found.size(), places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const double median = exhaustive_median(samples, places[i]);
    ASSERT_EQ(double{found[i]}, median) << i;
    ASSERT_LE(double{at_least_3[i]}, median) << i;
    ASSERT_TRUE(at_least_3[i] >= 3 || double{at_least_3[i]} == median) << i;
  }
}

TEST(SurfaceSpacing, IsNoLimitWithoutSurfaces) {
  EXPECT_TRUE(std::isinf(SurfaceSpacing({}, kBounds).at({1, 2, 3})));
  EXPECT_EQ(SurfaceSpacing({sample_at({0, 0, 0}, 3)}, kBounds).at({1, 2, 3}), 3) << "fewer than eight";
}

TEST(SurfaceSpacing, SamplesOfHugeCloudsAreSparser) {
  EXPECT_EQ(points_per_sample(0), 8U);
  EXPECT_EQ(points_per_sample(1000000), 8U);
  EXPECT_EQ(points_per_sample(uint64_t{1} << 30), 1024U);
}

}  // namespace
}  // namespace surfcast::estimation
