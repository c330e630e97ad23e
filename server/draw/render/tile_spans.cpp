#include "render/tile_spans.h"

#include <algorithm>
#include <iterator>

namespace surfcast::render {
namespace {

constexpr uint32_t kLengths[] = {SURFCAST_LIST_LENGTHS};
static_assert(std::size(kLengths) + 1 == kTileSpans && kLengths[kTileSpans - 2] == SURFCAST_LONG_LIST);

/// The average number of tiles per lane if lists are not longer than `longest`. It keeps the iterations of a lane below
/// the limit of llvmpipe. Eight lanes that share n tiles of up to eight surfaces draw at most n + 7 surfaces in
/// sequence, or eight if each lane has one tile. Each surface takes two passes over its list.
uint32_t turns_of(uint32_t longest) {
  if (longest <= 256) return 12;
  if (longest <= 512) return 6;
  return longest <= 1024 ? 3 : 1;
}

}  // namespace

std::vector<TileSpan> spans_of_tiles(const layout::Counters& counters, uint32_t tiles, const KernelShape& shape) {
  const auto at_once = static_cast<uint32_t>(shape.tiles_at_once);
  std::vector<TileSpan> spans;
  uint32_t first = 0;
  for (size_t i = kTileSpans; i-- > 0;) {
    const auto at = static_cast<glm::length_t>(i);
    const uint32_t end = i == 0 ? tiles : std::clamp(counters.lengths[(at - 1) / 4][(at - 1) % 4], first, tiles);
    if (i == std::size(kLengths)) {
      spans.push_back({first, end, 1, true});
    } else {
      spans.push_back({first, end, shape.whole_tiles ? at_once * turns_of(kLengths[i]) : at_once, false});
    }
    first = end;
  }
  return spans;
}

}  // namespace surfcast::render
