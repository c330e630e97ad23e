#pragma once

#include <filesystem>
#include <span>

#include "base/result.h"
#include "builder/build_options.h"
#include "builder/build_report.h"

namespace surfcast::builder {

/// Reads scans and makes surfels, reads regular grids (build_volumes), models of Gaussians (build_gaussians) and
/// ellipsoids (build_ellipsoids), and writes one model file, which appears only when it is complete. Inputs keep their
/// kinds. Blocks come in the order surfels, bricks, Gaussians, ellipsoids, whatever the order of the inputs; colours
/// and the vertical axis of the model are those of the first of these kinds. Scans that exceed the memory budget are
/// processed in parts, kept in a temporary file beside the target. The model depends on the input and the options: not
/// on the number of threads, and only minimally on the division into parts.
Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress);

}  // namespace surfcast::builder
