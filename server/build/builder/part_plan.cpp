#include "builder/part_plan.h"

#include <algorithm>
#include <numeric>
#include <utility>

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

/// The counted cells in a range of Morton codes.
Cells cells_between(Cells cells, uint64_t first_code, uint64_t end_code) {
  const auto at = [&](uint64_t code) {
    return std::partition_point(cells.begin(), cells.end(),
                                [code](const CountedCell& cell) { return cell.first_code < code; });
  };
  return {at(first_code), at(end_code)};
}

int shallowest(Cells cells) {
  return std::min_element(cells.begin(), cells.end(),
                          [](const CountedCell& a, const CountedCell& b) { return a.depth < b.depth; })
      ->depth;
}

/// The children of a cell that have points, each as a part.
std::vector<Part> children_of(Cells cells, int depth) {
  std::vector<Part> children;
  while (!cells.empty()) {
    const Part first = part_of(cells[0].first_code, depth + 1, 0);
    const Cells inside = cells_between(cells, first.first_code, first.end_code);
    children.push_back(part_of(first.first_code, depth + 1, total_count(inside)));
    cells = cells.subspan(inside.size());
  }
  return children;
}

/// The cells that a part can be cut between, each as a part: its own, or else the octants of its only one, or of the
/// only one of these, and so on. One where it cannot be cut.
std::vector<Part> pieces_of(const Part& part, Cells cells) {
  std::vector<Part> pieces;
  for (const ldc::OctreeKey& key : part.cells) {
    const uint64_t first = geometry::interleave({key.x, key.y, key.z})
                           << (3 * (geometry::kMortonDepth - int{key.depth}));
    const Part whole = part_of(first, key.depth, 0);
    pieces.push_back(part_of(first, key.depth, total_count(cells_between(cells, whole.first_code, whole.end_code))));
  }
  const Cells inside = cells_between(cells, part.first_code, part.end_code);
  while (pieces.size() == 1 && int{pieces[0].cells[0].depth} < shallowest(inside)) {
    pieces = children_of(inside, pieces[0].cells[0].depth);
  }
  return pieces;
}

Part joined(std::span<const Part> pieces) {
  Part all = pieces.front();
  for (const Part& piece : pieces.subspan(1)) {
    all.cells.push_back(piece.cells[0]);
    all.end_code = piece.end_code;
    all.count += piece.count;
  }
  return all;
}

/// Both halves of the pieces, as equal as they can be; there are at least two pieces.
std::pair<Part, Part> halves_of(std::span<const Part> pieces) {
  const uint64_t all = joined(pieces).count;
  size_t best = 1;
  uint64_t least = all;
  uint64_t before = 0;
  for (size_t i = 1; i < pieces.size(); ++i) {
    before += pieces[i - 1].count;
    const uint64_t larger = std::max(before, all - before);
    if (larger < least) best = i;
    least = std::min(least, larger);
  }
  return {joined(pieces.first(best)), joined(pieces.subspan(best))};
}

}  // namespace

std::vector<Part> plan_parts(std::span<const CountedCell> cells, uint64_t limit) {
  const uint64_t count = total_count(cells);
  if (count <= limit) return {part_of(0, 0, count)};
  std::vector<Part> parts;
  cut(cells, 0, limit, parts);
  return parts;
}

std::vector<Part> plan_part_count(std::span<const CountedCell> cells, size_t parts) {
  std::vector<Part> whole;  // cannot be cut
  std::vector<Part> plan{part_of(0, 0, total_count(cells))};
  while (!plan.empty() && plan.size() + whole.size() < parts) {
    const auto largest =
        std::max_element(plan.begin(), plan.end(), [](const Part& a, const Part& b) { return a.count < b.count; });
    const std::vector<Part> pieces = pieces_of(*largest, cells);
    if (pieces.size() == 1) {
      whole.push_back(std::move(*largest));
      plan.erase(largest);
      continue;
    }
    auto [first, second] = halves_of(pieces);
    *largest = std::move(first);
    plan.push_back(std::move(second));
  }
  plan.insert(plan.end(), whole.begin(), whole.end());
  std::sort(plan.begin(), plan.end(), [](const Part& a, const Part& b) { return a.first_code < b.first_code; });
  return plan;
}

}  // namespace surfcast::builder
