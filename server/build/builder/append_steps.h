#pragma once

#include <cstdint>

#include "base/result.h"
#include "builder/append_inputs.h"
#include "builder/append_model.h"
#include "builder/build_parts.h"
#include "builder/memory_budget.h"
#include "builder/part_store.h"
#include "builder/stage_clock.h"
#include "estimation/surfel_report.h"
#include "model/model_writer.h"
#include "model/statistics.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// Distributes former and new points to the regions of the plan. Returns the statistics of the former leaves that are
/// made anew.
Result<model::AttributeStatistics> distribute_points(const AppendInputs& inputs, const AppendPlan& plan,
                                                     const BuildFrame& frame, PartStore& store, StageClock& clock,
                                                     estimation::SurfelReport& report);

/// Writes the blocks of the grown model: those that are copied, those of the regions, and the levels above. `common`:
/// see write_blocks. Returns how many are copied.
Result<uint64_t> write_grown_blocks(const AppendInputs& inputs, const AppendPlan& plan, BuildParts& parts,
                                    const MemoryPlan& memory, const AppendOptions& options,
                                    const surfel::SurfelCloud& common, StageClock& clock, model::ModelWriter& writer);

}  // namespace surfcast::builder
