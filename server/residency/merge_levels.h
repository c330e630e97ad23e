#pragma once

#include <cstdint>
#include <vector>

#include "residency/merge_surfels.h"
#include "residency/packed_block.h"

namespace surfcast::residency {

/// Surfels of a packed block that are drawn or left out for the same reason (see SurfelSequence).
struct PackedRun {
  /// Radii of SURFCAST_CHUNK surfels, world units.
  struct Radii {
    float least = 0;           ///< of the surfels themselves
    float largest_merged = 0;  ///< of what they are merged to
  };

  uint32_t first = 0;  ///< even, if they are pairs
  uint32_t count = 0;
  bool finest = true;    ///< of the block itself; otherwise merged of surfels in an earlier run
  bool coarsest = true;  ///< not merged to any in a later run
  bool pairs = false;    ///< each two that follow each other are merged to one
  std::vector<Radii> chunks = {};
};

/// The surfels of a block, and behind them some levels of merged ones, each about half as many as the one before, so
/// that any spacing can be drawn at a cost that follows from it alone: of a surfel and what it is merged to, the one is
/// drawn that is just fine enough where it stands (shaders/include/spacing.glsl; a sequential point tree, Dachsbacher
/// 2003, of pairs).
struct SurfelSequence {
  std::vector<MergedSurfel> surfels;
  std::vector<PackedRun> runs;
};

/// `surfels` lie along a space filling curve; see merge_surfels. The sequence has at most kMaxPackedPerSurfel times as
/// many.
SurfelSequence merge_levels(std::vector<MergedSurfel> surfels, bool oriented);

}  // namespace surfcast::residency
