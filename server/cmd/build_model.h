#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/make_surfels.h"

namespace surfcast {

struct BuildOptions {
  std::optional<double> precision;  ///< largest position error, world units; none: 1/256 of each radius
  std::optional<bool> z_up;         ///< which axis is vertical, z or y; none: what each scan's format or look says
};

/// What a build did and what it took.
struct BuildReport {
  SurfelReport scan;
  uint64_t surfels = 0;
  uint64_t blocks = 0;
  uint64_t bytes = 0;        ///< of the model file
  double seconds = 0;        ///< wall time of the whole build
  uint64_t peak_memory = 0;  ///< largest resident size of this process so far, bytes

  [[nodiscard]] double points_per_second() const { return static_cast<double>(scan.points_read) / seconds; }
};

/// Told which stage is at work and which part of it is done, in [0, 1]; calls never overlap.
using BuildProgress = std::function<void(std::string_view stage, double part)>;

/// Reads scans, makes surfels of them and writes one model file; the target appears when it is whole.
Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress);

}  // namespace surfcast
