#include "builder/cell_counts.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace surfcast::builder {
namespace {

/// Depth of the first pass: 2^21 cells take 8 MiB and suffice for most scans.
constexpr int kFirstDepth = 7;
/// Levels by which an overfull cell is subdivided in the next pass.
constexpr int kMoreDepth = 4;

/// Counts the points of selected cells of one depth in their descendants `levels` deeper.
class CountingGrid {
 public:
  CountingGrid(std::vector<uint64_t> prefixes, int depth, int levels)
      : prefixes_(std::move(prefixes)), levels_(levels), depth_(depth + levels) {
    counts_ = std::vector<std::atomic<uint32_t>>(prefixes_.size() << (3 * levels));
  }

  void count(std::span<const uint64_t> codes) {
    for (const uint64_t code : codes) {
      const uint64_t cell = code >> (3 * (geometry::kMortonDepth - depth_));
      const uint64_t prefix = cell >> (3 * levels_);
      const auto found = std::lower_bound(prefixes_.begin(), prefixes_.end(), prefix);
      if (found == prefixes_.end() || *found != prefix) continue;
      const auto index = static_cast<uint64_t>(found - prefixes_.begin());
      const uint64_t inside = cell & ((uint64_t{1} << (3 * levels_)) - 1);
      counts_[index << (3 * levels_) | inside].fetch_add(1, std::memory_order_relaxed);
    }
  }

  [[nodiscard]] std::vector<CountedCell> cells() const {
    std::vector<CountedCell> cells;
    for (uint64_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i] == 0) continue;
      const uint64_t inside = i & ((uint64_t{1} << (3 * levels_)) - 1);
      const uint64_t cell = prefixes_[i >> (3 * levels_)] << (3 * levels_) | inside;
      cells.push_back({cell << (3 * (geometry::kMortonDepth - depth_)), depth_, counts_[i]});
    }
    return cells;
  }

 private:
  std::vector<uint64_t> prefixes_;  ///< of the selected cells, ascending
  int levels_;
  int depth_;
  std::vector<std::atomic<uint32_t>> counts_;
};

bool is_overfull(const CountedCell& cell, uint64_t limit) {
  return cell.count > limit && cell.depth < geometry::kMortonDepth;
}

}  // namespace

Result<std::vector<CountedCell>> count_cells(const CodePass& pass, uint64_t limit) {
  std::vector<CountedCell> done;
  std::vector<uint64_t> overfull = {0};
  for (int depth = 0; !overfull.empty();) {
    const int levels = std::min(depth == 0 ? kFirstDepth : kMoreDepth, geometry::kMortonDepth - depth);
    CountingGrid grid(std::exchange(overfull, {}), depth, levels);
    if (Status status = pass([&grid](std::span<const uint64_t> codes) { grid.count(codes); }); !status) {
      return fail(status);
    }
    depth += levels;
    for (const CountedCell& cell : grid.cells()) {
      if (is_overfull(cell, limit)) {
        overfull.push_back(cell.first_code >> (3 * (geometry::kMortonDepth - depth)));
      } else {
        done.push_back(cell);
      }
    }
  }
  std::sort(done.begin(), done.end(),
            [](const CountedCell& a, const CountedCell& b) { return a.first_code < b.first_code; });
  return done;
}

}  // namespace surfcast::builder
