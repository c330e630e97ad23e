#pragma once

#include <filesystem>
#include <span>

#include "builder/build_options.h"
#include "builder/build_report.h"
#include "builder/model_output.h"
#include "builder/stage_clock.h"

namespace surfcast::builder {

/// True if an input holds Gaussians, by its content.
bool holds_gaussians(const std::filesystem::path& input);

/// Reads models of Gaussians and adds their blocks to a model. Inputs that are trained in different ways, or have
/// different vertical axes, are refused. Gaussians that exceed the memory budget are sorted in a temporary file beside
/// the target. The model depends neither on the number of threads nor on the memory.
Status build_gaussians(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                       StageClock& clock, BuildReport& report);

}  // namespace surfcast::builder
