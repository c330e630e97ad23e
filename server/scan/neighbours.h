#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast {

/// The distinct positions of a cloud ("sites"), in coordinates local to it: from 0 to 1 along its longest axis. Points
/// at one position share one site, so no two sites are at distance 0, and differences and squares of local
/// coordinates are exact enough and far from overflow and underflow whatever the world coordinates are.
struct Sites {
  std::vector<glm::dvec3> positions;  ///< local
  std::vector<uint32_t> of_point;     ///< the site of every point of the cloud
  double unit = 1;                    ///< world units per local unit

  [[nodiscard]] size_t size() const { return positions.size(); }
};

Sites find_sites(std::span<const glm::dvec3> world);

/// For every site its nearest other sites, nearest first.
struct NeighbourGraph {
  size_t degree = 0;          ///< neighbours of each site; fewer than asked for only when there are too few sites
  std::vector<uint32_t> ids;  ///< `degree` entries for each site

  [[nodiscard]] std::span<const uint32_t> of(size_t site) const { return {ids.data() + site * degree, degree}; }
};

/// The result is the same for any number of threads.
NeighbourGraph find_neighbours(const Sites& sites, size_t degree);

}  // namespace surfcast
