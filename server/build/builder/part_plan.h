#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/cell_counts.h"
#include "ldc/octree_key.h"

namespace surfcast::builder {

/// A part of the cloud that is processed as a whole: adjacent octree cells under one parent, or the root alone.
struct Part {
  std::vector<ldc::OctreeKey> cells;  ///< of one depth, in Morton order
  uint64_t first_code = 0;            ///< Morton codes of its points: [first_code, end_code)
  uint64_t end_code = 0;
  uint64_t count = 0;  ///< points, including duplicates
};

/// Divides the counted cells into parts of at most `limit` points, in Morton order. A part of one cell of the greatest
/// depth may have more. Adjacent siblings share a part if they fit.
std::vector<Part> plan_parts(std::span<const CountedCell> cells, uint64_t limit);

/// Divides the counted cells into `parts` parts, in Morton order: again and again the largest part is cut in two,
/// between the cells or octants where the halves are most alike. Fewer parts where nothing is left to cut.
std::vector<Part> plan_part_count(std::span<const CountedCell> cells, size_t parts);

}  // namespace surfcast::builder
