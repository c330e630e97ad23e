#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scan/sites.h"

namespace surfcast::scan {

/// The nearest other sites of every site, nearest first.
struct NeighbourGraph {
  size_t degree = 0;          ///< neighbours of each site; fewer than requested only if there are too few sites
  std::vector<uint32_t> ids;  ///< `degree` entries for each site

  [[nodiscard]] std::span<const uint32_t> of(size_t site) const { return {ids.data() + site * degree, degree}; }
};

/// The result is the same for any number of threads.
NeighbourGraph find_neighbours(const Sites& sites, size_t degree);

}  // namespace surfcast::scan
