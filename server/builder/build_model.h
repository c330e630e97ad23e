#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "scan/surfel_report.h"

namespace surfcast::builder {

struct BuildOptions {
  std::optional<double> precision;      ///< largest position error, world units; none: 1/256 of each radius
  std::optional<bool> z_up;             ///< which axis is vertical, z or y; none: what each scan's format or look says
  std::optional<uint64_t> memory;       ///< most resident bytes to take; none: a quarter of the machine's memory
  std::optional<uint64_t> part_points;  ///< work in parts of at most so many points; none: what the memory allows
};

/// What a build did and what it took.
struct BuildReport {
  scan::SurfelReport scan;
  uint64_t surfels = 0;
  uint64_t blocks = 0;
  uint64_t bytes = 0;                                  ///< of the model file
  uint64_t parts = 0;                                  ///< that the scan was worked on in
  uint64_t memory_budget = 0;                          ///< bytes
  double seconds = 0;                                  ///< wall time of the whole build
  uint64_t peak_memory = 0;                            ///< largest resident size of this process so far, bytes
  std::vector<std::pair<std::string, double>> stages;  ///< seconds of each stage

  [[nodiscard]] double points_per_second() const { return static_cast<double>(scan.points_read) / seconds; }
};

/// How far a build is.
struct BuildStep {
  const char* stage = "";
  double done = 0;      ///< part of the stage, in [0, 1]
  uint64_t points = 0;  ///< that the stage goes through in all; 0 while that is not known
};

/// Told from any one thread at a time.
using BuildProgress = std::function<void(const BuildStep&)>;

/// Reads scans, makes surfels of them and writes one model file; the target appears when it is whole. Scans that do not
/// fit into the memory budget are worked on in parts, which wait in a temporary file beside the target. The model
/// depends on the input and the options alone: not on the number of threads, and nearly not on the parts.
Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress);

}  // namespace surfcast::builder
