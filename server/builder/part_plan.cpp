#include "builder/part_plan.h"

#include <algorithm>
#include <numeric>

namespace surfcast::builder {
namespace {

using Cells = std::span<const CountedCell>;

uint64_t total_count(Cells cells) {
  return std::accumulate(cells.begin(), cells.end(), uint64_t{0},
                         [](uint64_t sum, const CountedCell& cell) { return sum + cell.count; });
}

Part part_of(uint64_t code, int depth, uint64_t count) {
  const int shift = 3 * (geometry::kMortonDepth - depth);
  const uint64_t first = code >> shift << shift;
  return {{ldc::key_of_code(code, depth)}, first, first + (uint64_t{1} << shift), count};
}

/// Adds a cell to the last part if both have the same parent and fit together. `first_sibling` is the index of the
/// first part that holds only children of this parent.
void add_cell(const Part& cell, uint64_t limit, size_t first_sibling, std::vector<Part>& parts) {
  const bool joins = parts.size() > first_sibling && parts.back().cells.back().depth == cell.cells[0].depth &&
                     parts.back().count + cell.count <= limit;
  if (!joins) {
    parts.push_back(cell);
    return;
  }
  parts.back().cells.push_back(cell.cells[0]);
  parts.back().end_code = cell.end_code;
  parts.back().count += cell.count;
}

/// Divides a cell of the given depth that has too many points for one part.
void cut(Cells cells, int depth, uint64_t limit, std::vector<Part>& parts) {
  size_t first_sibling = parts.size();
  while (!cells.empty()) {
    const uint32_t octant = ldc::octant_of_code(cells[0].first_code, depth);
    const auto end = std::partition_point(cells.begin(), cells.end(), [&](const CountedCell& cell) {
      return ldc::octant_of_code(cell.first_code, depth) == octant;
    });
    const Cells child = cells.first(static_cast<size_t>(end - cells.begin()));
    cells = cells.subspan(child.size());
    const uint64_t count = total_count(child);
    if (count <= limit || depth + 1 == geometry::kMortonDepth) {
      add_cell(part_of(child[0].first_code, depth + 1, count), limit, first_sibling, parts);
    } else {
      cut(child, depth + 1, limit, parts);
      first_sibling = parts.size();
    }
  }
}

}  // namespace

std::vector<Part> plan_parts(std::span<const CountedCell> cells, uint64_t limit) {
  const uint64_t count = total_count(cells);
  if (count <= limit) return {part_of(0, 0, count)};
  std::vector<Part> parts;
  cut(cells, 0, limit, parts);
  return parts;
}

}  // namespace surfcast::builder
