#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.h"
#include "scan/scan_schema.h"

namespace surfcast::builder {

/// Bytes from a size like "4G", "512M" or "4294967296"; K, M and G are powers of 1024.
std::optional<uint64_t> parse_memory_size(std::string_view text);

/// Memory of this machine, or of the control group that this process is held to.
uint64_t machine_memory();

/// How a build keeps within its memory.
struct MemoryPlan {
  uint64_t budget = 0;        ///< bytes of resident memory
  uint64_t for_parts = 0;     ///< of these for the points that are worked on
  uint64_t per_point = 0;     ///< that one of them takes at most
  uint64_t part_points = 0;   ///< the most that a part of a scan in parts has, its halo not counted
  uint64_t whole_points = 0;  ///< a scan of so many is one part

  [[nodiscard]] bool fits_whole(uint64_t points) const { return points <= whole_points; }
  /// Cuts scans into smaller parts than the memory would take.
  void split_into(uint64_t points) { whole_points = part_points = points; }
  /// Parts with at most so many points, halo included, that fit side by side; 0 if not even one does.
  [[nodiscard]] size_t parts_at_once(uint64_t points) const {
    return static_cast<size_t>(for_parts / (per_point * points));
  }
};

/// The budget, or without one a quarter of the machine's memory. Fails when it is more than the machine has.
Result<uint64_t> memory_budget(std::optional<uint64_t> wanted);

/// Divides a budget for points of that schema; `held` bytes of it are taken for good. Fails when the budget is too
/// small to work with. The plan does not depend on the number of threads.
Result<MemoryPlan> plan_memory(uint64_t budget, uint64_t held, const scan::ScanSchema& schema);

}  // namespace surfcast::builder
