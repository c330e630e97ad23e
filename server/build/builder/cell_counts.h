#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// An octree cell and the number of points in it.
struct CountedCell {
  uint64_t first_code = 0;  ///< the lowest Morton code of the cell
  int depth = 0;
  uint64_t count = 0;

  /// The end of the cell's Morton codes (exclusive).
  [[nodiscard]] uint64_t end_code() const {
    return first_code + (uint64_t{1} << (3 * (geometry::kMortonDepth - depth)));
  }
};

/// Runs over all points: passes their Morton codes to `count`, from any thread.
using CodePass = std::function<Status(const std::function<void(std::span<const uint64_t> codes)>& count)>;

/// Counts points in octree cells. Cells with more than `limit` points are counted again in smaller cells, down to the
/// greatest depth. Every repetition is one pass over all points. Returns the non-empty cells in Morton order.
Result<std::vector<CountedCell>> count_cells(const CodePass& pass, uint64_t limit);

}  // namespace surfcast::builder
