#pragma once

#include "builder/build_model.h"
#include "builder/stage_clock.h"

namespace surfcast::builder {

/// True if an input holds Gaussians, by its content.
bool holds_gaussians(const std::filesystem::path& input);

/// Reads models of Gaussians and writes them as one model file. Inputs that are trained in different ways, or have
/// different vertical axes, are refused. Gaussians that exceed the memory budget are sorted in a temporary file beside
/// the target. The model depends neither on the number of threads nor on the memory.
Status build_gaussians(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                       const BuildOptions& options, StageClock& clock, BuildReport& report);

}  // namespace surfcast::builder
