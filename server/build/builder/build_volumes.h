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

}  // namespace surfcast::builder
