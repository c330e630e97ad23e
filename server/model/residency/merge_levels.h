#pragma once

#include <cstdint>
#include <vector>

#include "residency/merge_surfels.h"
#include "residency/packed_block.h"

namespace surfcast::residency {

/// Surfels of a packed block that share the conditions under which they are drawn (see SurfelSequence).
struct PackedRun {
  /// Radii of SURFCAST_CHUNK surfels, world units.
  struct Radii {
    float least = 0;           ///< of the surfels themselves
    float largest_merged = 0;  ///< of the surfels that they are merged to
  };

  uint32_t first = 0;  ///< even for pairs
  uint32_t count = 0;
  bool finest = true;    ///< surfels of the block itself; otherwise merged from surfels in an earlier run
  bool coarsest = true;  ///< not merged to a surfel in a later run
  bool pairs = false;    ///< each two consecutive surfels are merged to one
  bool scatter = false;  ///< all its surfels are scatter; otherwise none is
  std::vector<Radii> chunks = {};
};

/// The surfels of a block, followed by levels of merged surfels, each about half as many as the one before. So any
/// spacing can be drawn at a cost that depends on the spacing alone. Of a surfel and the surfel that it is merged to,
/// one is drawn: the one that is just fine enough at its position (shaders/include/spacing.glsl). This is a sequential
/// point tree (Dachsbacher 2003) of pairs. Discs and scatter are merged each for themselves.
struct SurfelSequence {
  std::vector<MergedSurfel> surfels;
  std::vector<PackedRun> runs;
};

/// `surfels` are ordered along a space filling curve; see merge_surfels. The sequence has at most kMaxPackedPerSurfel
/// times as many surfels.
SurfelSequence merge_levels(std::vector<MergedSurfel> surfels, bool oriented);

}  // namespace surfcast::residency
