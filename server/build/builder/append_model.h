#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "base/result.h"
#include "builder/build_options.h"
#include "builder/build_report.h"
#include "builder/place_inputs.h"
#include "estimation/stated_radii.h"
#include "scan/selection.h"

namespace surfcast::builder {

struct AppendOptions {
  std::optional<double> precision;  ///< this and the following: see BuildOptions
  std::optional<uint64_t> memory;
  std::optional<uint64_t> part_points{};
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
  scan::Selection selection{};
  SystemOptions systems{};  ///< of the scans; the model's stays
};

/// Adds scans to a model of scans. Only the blocks near new points are made anew, from the points that they have and
/// the new ones; all others are copied byte for byte. The file is replaced when the new one is complete. Fails without
/// a change of the model if it is not one of scans alone, or if the scans do not fit: with attributes that it lacks, in
/// another coordinate system, or too far away.
Result<BuildReport> append_to_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& model,
                                    const AppendOptions& options, const BuildProgress& progress);

}  // namespace surfcast::builder
