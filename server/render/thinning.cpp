#include "render/thinning.h"

#include <algorithm>

namespace surfcast::render {

Thinning next_thinning(const layout::Counters& counters, const Thinning& tried, size_t list_limit) {
  const uint32_t longest = counters.counts.w;
  if (tried.most == 0) return {longest > SURFCAST_TILE_CAPACITY ? SURFCAST_TILE_CAPACITY : 0U, false};
  const bool lists_fit = counters.counts.z <= list_limit;
  const bool loops_fit = longest <= SURFCAST_TILE_CAPACITY_LIMIT;
  if (!tried.alike) return {tried.most, !loops_fit || !lists_fit};
  if (!lists_fit) return {std::max(tried.most / 2, 1U), true};
  return {loops_fit ? tried.most : std::max(3 * tried.most / 4, 1U), true};
}

}  // namespace surfcast::render
