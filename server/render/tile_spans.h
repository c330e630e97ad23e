#pragma once

#include <cstdint>
#include <vector>

#include "render/programs.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

/// Tiles with lists of about one length: places in the order of tiles, from the longest lists to the shortest.
struct TileSpan {
  uint32_t first = 0;
  uint32_t end = 0;
  uint32_t tiles_per_group = 1;  ///< tiles of a work group of the splat kernel
  bool operator==(const TileSpan&) const = default;
};

/// Spans of any counts: one for each of SURFCAST_LIST_LENGTHS, and one of tiles without splats.
inline constexpr size_t kTileSpans = 9;

/// Cuts all tiles into spans, some of which may be empty; the first one has the longest lists. They are drawn one by
/// one because their tiles cost so different amounts that no size of a batch suits all.
///
/// Where lanes take turns, the more tiles a group has the less they wait for each other at its end. But software GL
/// ends the loops of a lane after 65535 rounds in all, silently, and all lanes go round as long as one of them has
/// work: tiles with long lists get small groups.
std::vector<TileSpan> spans_of_tiles(const layout::Counters& counters, uint32_t tiles, const KernelShape& shape);

}  // namespace surfcast::render
