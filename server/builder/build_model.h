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
#include "builder/build_inputs.h"
#include "scan/stated_radii.h"
#include "scan/surfel_report.h"

namespace surfcast::builder {

struct BuildOptions {
  std::optional<double> precision;      ///< largest position error, world units; none: 1/256 of each radius
  std::optional<bool> z_up;             ///< vertical axis z (true) or y; none: as each scan's format or points suggest
  std::optional<uint64_t> memory;       ///< limit of resident memory, bytes; none: a quarter of the machine's memory
  std::optional<uint64_t> part_points;  ///< largest number of points of a part; none: as the memory allows
  scan::RadiusPolicy radii = scan::RadiusPolicy::kAuto;
  std::optional<uint64_t> sample{};  ///< points of each scan, spread over it, that a preview is made of; none: all
  OpenInput open{};                  ///< how inputs are read as points; none: scans are, and grids become volumes
};

/// What became of the radii that an input states.
struct InputRadii {
  std::string input;  ///< file name without its folders
  scan::RadiusDecision decision;
};

/// The result and the cost of a build.
struct BuildReport {
  scan::SurfelReport scan;
  std::vector<InputRadii> radii;  ///< of the inputs that have a column for them
  uint64_t points_in_scans = 0;   ///< beyond BuildOptions::sample too
  uint64_t samples = 0;           ///< of the volumes
  uint64_t surfels = 0;
  uint64_t gaussians = 0;
  uint64_t blocks = 0;
  uint64_t bytes = 0;                                  ///< of the model file
  uint64_t parts = 0;                                  ///< parts in which the scan was processed
  uint64_t memory_budget = 0;                          ///< bytes
  double seconds = 0;                                  ///< wall time of the whole build
  uint64_t peak_memory = 0;                            ///< peak resident size of this process so far, bytes
  std::vector<std::pair<std::string, double>> stages;  ///< seconds of each stage

  [[nodiscard]] double points_per_second() const { return static_cast<double>(scan.points_read) / seconds; }
  [[nodiscard]] double samples_per_second() const { return static_cast<double>(samples) / seconds; }
};

/// Progress of a build.
struct BuildStep {
  const char* stage = "";
  double done = 0;      ///< completed share of the stage, in [0, 1]
  uint64_t points = 0;  ///< total number of points of the stage; 0 while unknown
};

/// Called from any thread, but from one at a time.
using BuildProgress = std::function<void(const BuildStep&)>;

/// Reads scans and makes surfels, or reads regular grids (build_volumes) or models of Gaussians (build_gaussians), and
/// writes one model file, which appears only when it is complete. Fails on inputs of several kinds. Scans that exceed
/// the memory budget are processed in parts, kept in a temporary file beside the target. The model depends on the input
/// and the options: not on the number of threads, and only minimally on the division into parts.
Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress);

}  // namespace surfcast::builder
