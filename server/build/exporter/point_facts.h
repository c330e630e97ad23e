#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "geometry/box.h"
#include "surfel/grid.h"

namespace surfcast::exporter {

/// Which facts are needed. The number of points is known sooner: blocks whose points all lie in a region are not read.
enum class WantedFacts { kNumber, kAll };

/// What is known of all points before the first of them is written: heads of files state it.
struct PointFacts {
  uint64_t count = 0;
  geometry::Box bounds;
  std::array<uint64_t, 15> returns{};  ///< points by return number, from 1
  std::optional<surfel::Grid> grid{};  ///< on which all positions lie; none: there is none, or several

  /// Takes further points in.
  void add(const PointFacts& more) {
    if (more.count == 0) return;
    if (count == 0) grid = more.grid;
    if (grid != more.grid) grid.reset();
    count += more.count;
    bounds.include(more.bounds);
    for (size_t i = 0; i < returns.size(); ++i) returns[i] += more.returns[i];
  }
};

}  // namespace surfcast::exporter
