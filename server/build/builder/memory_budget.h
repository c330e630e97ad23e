#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.h"
#include "scan/scan_schema.h"

namespace surfcast::builder {

/// Parses a size like "4G", "512M" or "4294967296" to bytes; K, M and G are powers of 1024.
std::optional<uint64_t> parse_memory_size(std::string_view text);

/// Memory of this machine, or the limit of this process's control group, bytes.
uint64_t machine_memory();

/// How a build divides its memory budget.
struct MemoryPlan {
  uint64_t budget = 0;        ///< bytes of resident memory
  uint64_t for_parts = 0;     ///< share of the budget for the points being processed, bytes
  uint64_t per_point = 0;     ///< most bytes that a point takes while it is processed
  uint64_t part_points = 0;   ///< most points of a part if there are several, halo excluded
  uint64_t whole_points = 0;  ///< a scan of at most this many points is a single part

  [[nodiscard]] bool fits_whole(uint64_t points) const { return points <= whole_points; }
  /// Limits parts to fewer points than the memory allows.
  void split_into(uint64_t points) { whole_points = part_points = points; }
  /// The number of parts with `points` points each, halo included, that fit into memory together; may be 0.
  [[nodiscard]] size_t parts_at_once(uint64_t points) const {
    return static_cast<size_t>(for_parts / (per_point * points));
  }
};

/// The requested budget, or a quarter of the machine's memory. Fails if it exceeds the machine's memory.
Result<uint64_t> memory_budget(std::optional<uint64_t> wanted);

/// Plans a budget for points of this schema. `held` bytes of it are occupied for the whole build. Fails with kLimit if
/// the budget is too small. The plan does not depend on the number of threads.
Result<MemoryPlan> plan_memory(uint64_t budget, uint64_t held, const scan::ScanSchema& schema);

}  // namespace surfcast::builder
