#include "estimation/neighbours.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/shapes.h"

namespace surfcast::estimation {
namespace {

Sites sites_of(const std::vector<glm::dvec3>& world) {
  geometry::Box frame;
  for (const glm::dvec3& p : world) frame.include(p);
  return find_sites(world, frame);
}

/// The nearest sites by comparing all, the lower number first of equally near ones.
std::vector<uint32_t> exhaustive_search(const Sites& sites, uint32_t from, size_t degree) {
  std::vector<std::pair<double, uint32_t>> others;
  for (uint32_t j = 0; j < sites.size(); ++j) {
    const glm::dvec3 d = sites.positions[j] - sites.positions[from];
    if (j != from) others.emplace_back(glm::dot(d, d), j);
  }
  const auto end = others.begin() + static_cast<std::ptrdiff_t>(std::min(degree, others.size()));
  std::partial_sort(others.begin(), end, others.end());
  std::vector<uint32_t> nearest;
  std::transform(others.begin(), end, std::back_inserter(nearest), [](const auto& found) { return found.second; });
  return nearest;
}

/// Expects the neighbours of every `step`th site to be those of the exhaustive search.
void expect_exact(const std::vector<glm::dvec3>& world, size_t degree, size_t step = 1) {
  const Sites sites = sites_of(world);
  const NeighbourGraph graph = find_neighbours(sites, degree);
  ASSERT_EQ(graph.degree, std::min({degree, sites.size() - 1, kLargestDegree}));
  for (uint32_t i = 0; i < sites.size(); i += static_cast<uint32_t>(step)) {
    ASSERT_THAT(graph.of(i), ::testing::ElementsAreArray(exhaustive_search(sites, i, graph.degree))) << i;
  }
}

TEST(NeighboursTest, AreThoseOfAnExhaustiveSearch) {
  for (const size_t degree : {1u, 7u, 12u, 32u}) {
    expect_exact(testing::noise(700, 3), degree);
    expect_exact(testing::sphere(3000, {1, 2, 3}, 2), degree, 7);
  }
}

TEST(NeighboursTest, AreExactWhereManyAreEquallyNear) {
  for (const size_t degree : {6u, 12u, 32u}) expect_exact(testing::square_lattice(40, 0.01, {5, 6, 7}), degree, 3);
}

TEST(NeighboursTest, AreExactOnALine) {
  std::vector<glm::dvec3> line;
  for (int i = 0; i < 2000; ++i) line.push_back(glm::dvec3(1, 2, -1) * (i + 0.3 * std::sin(i)));
  for (const size_t degree : {2u, 12u, 32u}) expect_exact(line, degree, 7);
}

TEST(NeighboursTest, AreExactAmongMillimetresTenThousandKilometresFromTheOrigin) {
  std::vector<glm::dvec3> far = testing::noise(2000, 0.05);
  for (glm::dvec3& p : far) p += glm::dvec3(1e7, -1e7, 3e3);
  expect_exact(far, 12, 7);
}

TEST(NeighboursTest, AreExactWhereSpacingsDifferATrillionfold) {
  std::vector<glm::dvec3> nested;
  for (int level = 0; level < 12; ++level) {
    for (const glm::dvec3& p : testing::noise(300, std::pow(10.0, -level))) nested.push_back(p);
  }
  for (const size_t degree : {12u, 32u}) expect_exact(nested, degree, 5);
}

TEST(NeighboursTest, AreExactInASweepOfALaserScanner) {
  // 32 rings on the ground: points on a ring are a hundred times as near to each other as rings far out.
  std::vector<glm::dvec3> sweep;
  for (int ring = 0; ring < 32; ++ring) {
    const double radius = 1.8 / std::tan(0.02 + 0.015 * ring);
    for (int i = 0; i < 900; ++i) {
      const double angle = 2 * std::numbers::pi * i / 900;
      sweep.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.01 * std::sin(37.0 * i * (ring + 1)));
    }
  }
  expect_exact(sweep, 12, 97);
  expect_exact(sweep, 32, 97);
}

TEST(NeighboursTest, AreExactBesideAClusterFarSmallerThanTheSmallestCellOfTheFrame) {
  std::vector<glm::dvec3> world = testing::noise(20000, 1e-4);
  world.emplace_back(1e6, 0, 0);  // the cells of the frame are half a metre wide
  world.emplace_back(1e6, 3, 0);
  expect_exact(world, 12, 401);
  const Sites sites = sites_of(world);
  EXPECT_THAT(find_neighbours(sites, 12).of(sites.of_point[20000]),
              ::testing::ElementsAreArray(exhaustive_search(sites, sites.of_point[20000], 12)));
}

TEST(NeighboursTest, ASearchGivesTheDistancesInAscendingOrderForEverySiteOnce) {
  const Sites sites = sites_of(testing::noise(3000, 2));
  std::vector<int> calls(sites.size());
  for_each_neighbourhood(sites, 32, [&](const Neighbours& found) {
    ++calls[found.site];
    ASSERT_EQ(found.ids.size(), 32u);
    ASSERT_EQ(found.squared_distances.size(), 32u);
    EXPECT_TRUE(std::is_sorted(found.squared_distances.begin(), found.squared_distances.end()));
    for (size_t k = 0; k < 32; ++k) {
      const glm::dvec3 d = sites.positions[found.ids[k]] - sites.positions[found.site];
      EXPECT_EQ(found.squared_distances[k], glm::dot(d, d));
    }
  });
  EXPECT_THAT(calls, ::testing::Each(1));
}

/// Processor seconds to find the neighbours of points of which half are in one spot of the size `spot`.
double seconds_beside_a_cluster(int count, double spot) {
  std::vector<glm::dvec3> world = testing::noise(count, 1);
  for (const glm::dvec3& p : testing::noise(count, spot)) world.push_back(glm::dvec3(0.3) + p);
  const Sites sites = sites_of(world);
  const std::clock_t start = std::clock();
  find_neighbours(sites, 12);
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

TEST(NeighboursTest, BesideADenseClusterTakeNoQuadraticTime) {
  for (const double spot : {1e-3, 1e-8}) {
    const double once = seconds_beside_a_cluster(20000, spot);
    const double fourfold = seconds_beside_a_cluster(80000, spot);
    EXPECT_LT(fourfold / once, 10) << "4 would be linear, 16 quadratic";
  }
}

TEST(NeighboursTest, SitesAreDistinctAndEveryPointHasItsOwn) {
  std::vector<glm::dvec3> world = testing::noise(100, 3);
  world.insert(world.end(), world.begin(), world.end());
  const Sites sites = sites_of(world);
  EXPECT_EQ(sites.size(), 100u);
  for (size_t i = 0; i < 100; ++i) EXPECT_EQ(sites.of_point[i], sites.of_point[i + 100]);
  const double local = glm::distance(sites.positions[sites.of_point[3]], sites.positions[sites.of_point[8]]);
  EXPECT_NEAR(local * sites.unit, glm::distance(world[3], world[8]), 1e-12);
}

TEST(NeighboursTest, FewSitesHaveFewerNeighbours) {
  EXPECT_EQ(find_neighbours(sites_of(std::vector<glm::dvec3>{{1, 2, 3}}), 12).degree, 0u);
  EXPECT_EQ(find_neighbours(sites_of(std::vector<glm::dvec3>{{1, 2, 3}, {1, 2, 4}}), 12).degree, 1u);
}

}  // namespace
}  // namespace surfcast::estimation
