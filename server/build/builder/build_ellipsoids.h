#pragma once

#include <filesystem>
#include <span>

#include "builder/build_options.h"
#include "builder/build_report.h"
#include "builder/model_output.h"
#include "builder/stage_clock.h"

namespace surfcast::builder {

/// Reads tensor fields and tables of ellipsoids and adds their blocks to a model, a tree for each input. Ellipsoids
/// that exceed the memory budget are sorted in a temporary file beside the target. The model depends neither on the
/// number of threads nor on the memory. What cannot be drawn is counted and noted.
Status build_ellipsoids(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                        StageClock& clock, BuildReport& report);

}  // namespace surfcast::builder
