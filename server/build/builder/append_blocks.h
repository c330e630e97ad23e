#pragma once

#include <cstdint>

#include "base/result.h"
#include "builder/append_inputs.h"
#include "builder/append_model.h"
#include "builder/build_parts.h"
#include "builder/memory_budget.h"
#include "builder/stage_clock.h"
#include "model/model_writer.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// Writes the blocks of the grown model: those that are copied, those of the regions, and the levels above. `common`:
/// see write_blocks. Returns how many are copied.
Result<uint64_t> write_grown_blocks(const AppendInputs& inputs, const AppendPlan& plan, BuildParts& parts,
                                    const MemoryPlan& memory, const AppendOptions& options,
                                    const surfel::SurfelCloud& common, StageClock& clock, model::ModelWriter& writer);

}  // namespace surfcast::builder
