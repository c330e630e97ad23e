#pragma once

#include <filesystem>
#include <span>

#include "base/result.h"
#include "builder/build_model.h"
#include "builder/model_output.h"
#include "builder/stage_clock.h"

namespace surfcast::builder {

/// Makes a volume of each grid and adds its bricks to a model. Memory depends on the size of their planes.
/// `report` has the budget; the rest of it is filled in.
Status build_volumes(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                     StageClock& clock, BuildReport& report);

}  // namespace surfcast::builder
