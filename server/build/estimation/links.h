#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "estimation/neighbours.h"

namespace surfcast::estimation {

/// Neighbours of each site along which signs are propagated, at most 8. More of them only cost time.
inline constexpr size_t kLinks = 8;

/// The most sites of a part: pairs of linked sites have numbers of 32 bits.
inline constexpr size_t kMaxSites = (size_t{1} << 32U) / kLinks - 1;

/// The pairs of linked sites. A pair is linked if either site is a near neighbour of the other.
class Links {
 public:
  Links(const NeighbourGraph& graph, size_t sites) : graph_(graph), listed_(sites) {
    tbb::parallel_for(size_t{0}, sites, [this](size_t a) { listed_[a] = pairs_listed_at(static_cast<uint32_t>(a)); });
  }

  [[nodiscard]] size_t sites() const { return listed_.size(); }

  /// Calls `use(a, b)` for the pairs listed at the sites from `first` to before `last`. Every pair is listed at one of
  /// its sites.
  template <typename Use>
  void for_each(size_t first, size_t last, const Use& use) const {
    for_each_numbered(first, last, [&use](uint32_t a, uint32_t b, uint32_t) { use(a, b); });
  }

  /// The same, and passes the number of the pair, which ascends from call to call.
  template <typename Use>
  void for_each_numbered(size_t first, size_t last, const Use& use) const {
    for (size_t a = first; a < last; ++a) {
      const std::span<const uint32_t> near = near_to(a);
      for (size_t k = 0; k < near.size(); ++k) {
        if ((listed_[a] >> k & 1U) != 0) use(static_cast<uint32_t>(a), near[k], static_cast<uint32_t>(a * kLinks + k));
      }
    }
  }

  /// The sites of a pair by its number.
  [[nodiscard]] std::pair<uint32_t, uint32_t> pair(uint32_t number) const {
    const auto a = static_cast<uint32_t>(number / kLinks);
    return {a, near_to(a)[number % kLinks]};
  }

 private:
  [[nodiscard]] std::span<const uint32_t> near_to(size_t site) const {
    return graph_.of(site).first(std::min(kLinks, graph_.degree));
  }

  /// Bit k is set if the pair with neighbour k is listed here: the other site is a later one, or does not list it.
  [[nodiscard]] uint8_t pairs_listed_at(uint32_t a) const {
    unsigned listed = 0;
    const std::span<const uint32_t> near = near_to(a);
    for (size_t k = 0; k < near.size(); ++k) {
      const std::span<const uint32_t> back = near_to(near[k]);
      if (a < near[k] || std::find(back.begin(), back.end(), a) == back.end()) listed |= 1U << k;
    }
    return static_cast<uint8_t>(listed);
  }

  const NeighbourGraph& graph_;
  std::vector<uint8_t> listed_;  ///< for each site
};

}  // namespace surfcast::estimation
