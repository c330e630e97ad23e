#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "scan/neighbours.h"

namespace surfcast::scan {

/// Neighbours of each site along which signs are propagated. More of them only cost time.
inline constexpr size_t kLinks = 8;

[[nodiscard]] inline std::span<const uint32_t> links_of(const NeighbourGraph& graph, size_t site) {
  return graph.of(site).first(std::min(kLinks, graph.degree));
}

/// Calls `use(a, b)` once for every pair of linked sites. A pair is linked if either site is a near neighbour of the
/// other.
template <typename Use>
void for_each_link(const NeighbourGraph& graph, size_t sites, const Use& use) {
  for (uint32_t a = 0; a < sites; ++a) {
    for (const uint32_t b : links_of(graph, a)) {
      const auto back = links_of(graph, b);
      if (a < b || std::find(back.begin(), back.end(), a) == back.end()) use(a, b);
    }
  }
}

}  // namespace surfcast::scan
