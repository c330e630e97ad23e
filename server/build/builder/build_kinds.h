#pragma once

#include <filesystem>
#include <span>

#include "base/result.h"
#include "builder/build_options.h"
#include "builder/build_report.h"
#include "builder/model_output.h"
#include "builder/stage_clock.h"

namespace surfcast::builder {

/// Makes a volume of each grid, and of each table of points that is a field (BuildOptions::field), and adds their
/// bricks to a model. Memory depends on the size of their planes, and on the number of points of a field. `report` has
/// the budget; the rest of it is filled in.
Status build_volumes(std::span<const std::filesystem::path> grids, std::span<const std::filesystem::path> fields,
                     ModelOutput& output, const BuildOptions& options, StageClock& clock, BuildReport& report);

/// True if an input holds Gaussians, by its content.
bool holds_gaussians(const std::filesystem::path& input);

/// Reads models of Gaussians and adds their blocks to a model. Inputs that are trained in different ways, or have
/// different vertical axes, are refused. Gaussians that exceed the memory budget are sorted in a temporary file beside
/// the target. The model depends neither on the number of threads nor on the memory.
Status build_gaussians(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                       StageClock& clock, BuildReport& report);

/// Reads tensor fields and tables of ellipsoids and adds their blocks to a model, a tree for each input. Ellipsoids
/// that exceed the memory budget are sorted in a temporary file beside the target. The model depends neither on the
/// number of threads nor on the memory. What cannot be drawn is counted and noted.
Status build_ellipsoids(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                        StageClock& clock, BuildReport& report);

}  // namespace surfcast::builder
