#pragma once

#include <cstdint>
#include <vector>

#include "render/programs.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

/// Tiles with lists of similar lengths: indices [first, end) in the order of tiles, which is by descending list length.
struct TileSpan {
  uint32_t first = 0;
  uint32_t end = 0;
  uint32_t tiles_per_group = 1;  ///< tiles per work group of the splat kernel
  bool together = false;         ///< long lists: the lanes of a work group share the list of a tile
  bool operator==(const TileSpan&) const = default;
};

/// Number of spans: one for each of SURFCAST_LIST_LENGTHS, and one for tiles without splats.
inline constexpr size_t kTileSpans = 9;

/// Divides all tiles into spans, some of which may be empty. The first one has the longest lists. Spans are drawn one
/// by one because the cost of their tiles differs too much for a common batch size.
///
/// If lanes continue with the next tile (KernelShape::whole_tiles), larger groups spend less time waiting for their
/// last lane. But llvmpipe silently ends the loops of a lane after 65535 iterations in total, and all lanes iterate as
/// long as one of them has work. So tiles with long lists get small groups.
std::vector<TileSpan> spans_of_tiles(const layout::Counters& counters, uint32_t tiles, const KernelShape& shape);

}  // namespace surfcast::render
