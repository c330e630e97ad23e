#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "estimation/sites.h"

namespace surfcast::estimation {

/// The nearest other sites of one site, nearest first; equally near ones by their numbers.
struct Neighbours {
  uint32_t site = 0;
  std::span<const uint32_t> ids;
  std::span<const double> squared_distances;  ///< local units
};

/// The most neighbours of a site that a search finds.
inline constexpr size_t kLargestDegree = 32;

/// Calls `use` once for every site with its `degree` nearest neighbours: fewer if there are too few sites, at most
/// kLargestDegree. Not called for a single site. `use` is called from any thread, in any order; its arguments live
/// until it returns. The search is exact: all tests of distance are decided in double precision. The arguments do not
/// depend on the number of threads.
void for_each_neighbourhood(const Sites& sites, size_t degree, const std::function<void(const Neighbours&)>& use);

/// The nearest other sites of every site, nearest first.
struct NeighbourGraph {
  size_t degree = 0;          ///< neighbours of each site; fewer than requested only if there are too few sites
  std::vector<uint32_t> ids;  ///< `degree` entries for each site

  [[nodiscard]] std::span<const uint32_t> of(size_t site) const { return {ids.data() + site * degree, degree}; }
};

/// The sites of points and their nearest sites.
struct Neighbourhoods {
  Sites sites;
  NeighbourGraph graph;
};

/// The distance of a site to its third nearest, which tells how dense the sites are; paired echoes do not affect it.
/// Local units. There must be so many neighbours.
double third_distance(const Sites& sites, const NeighbourGraph& graph, uint32_t site);

/// Called with a site and its nearest other sites, nearest first. Several sites are visited at the same time.
using NeighbourVisitor = std::function<void(uint32_t site, std::span<const uint32_t> neighbours)>;

/// The result is the same for any number of threads.
NeighbourGraph find_neighbours(const Sites& sites, size_t degree);
/// Of points within `frame`.
Neighbourhoods find_neighbourhoods(std::span<const glm::dvec3> world, const geometry::Box& frame, size_t degree);

/// The same, and calls `visit` with `visited` neighbours of every site (fewer if there are too few sites), of which
/// the graph keeps the first `degree`.
NeighbourGraph find_neighbours(const Sites& sites, size_t degree, size_t visited, const NeighbourVisitor& visit);

}  // namespace surfcast::estimation
