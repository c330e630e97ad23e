#include "scan/neighbours.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/shapes.h"

namespace surfcast::scan {
namespace {

Sites sites_of(const std::vector<glm::dvec3>& world) {
  geometry::Box frame;
  for (const glm::dvec3& p : world) frame.include(p);
  return find_sites(world, frame);
}

TEST(NeighboursTest, AreThoseOfAnExhaustiveSearch) {
  const Sites sites = sites_of(testing::noise(500, 3));
  constexpr size_t kDegree = 7;
  const NeighbourGraph graph = find_neighbours(sites, kDegree);
  for (size_t i = 0; i < sites.size(); ++i) {
    std::vector<uint32_t> others;
    for (uint32_t j = 0; j < sites.size(); ++j) {
      if (j != i) others.push_back(j);
    }
    std::sort(others.begin(), others.end(), [&](uint32_t a, uint32_t b) {
      return glm::distance(sites.positions[a], sites.positions[i]) <
             glm::distance(sites.positions[b], sites.positions[i]);
    });
    others.resize(kDegree);
    EXPECT_THAT(graph.of(i), ::testing::ElementsAreArray(others));
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
}  // namespace surfcast::scan
