#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/cell_counts.h"
#include "ldc/octree_key.h"

namespace surfcast::builder {

/// A part of the cloud that is worked on as a whole: octree cells side by side under one parent, or the root alone.
struct Part {
  std::vector<ldc::OctreeKey> cells;  ///< of one depth, in Morton order
  uint64_t first_code = 0;            ///< Morton codes of its points, the end excluded
  uint64_t end_code = 0;
  uint64_t count = 0;  ///< points, duplicates included
};

/// Cuts the counted cells into parts of at most `limit` points, in Morton order; a part of one smallest cell may have
/// more. Siblings next to each other share a part if they fit.
std::vector<Part> plan_parts(std::span<const CountedCell> cells, uint64_t limit);

}  // namespace surfcast::builder
