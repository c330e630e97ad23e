#pragma once

#include "base/result.h"
#include "builder/append_inputs.h"
#include "builder/build_parts.h"
#include "builder/part_store.h"
#include "builder/stage_clock.h"
#include "estimation/surfel_report.h"
#include "model/statistics.h"

namespace surfcast::builder {

/// Distributes former and new points to the regions of the plan. Returns the statistics of the former leaves that are
/// made anew.
Result<model::AttributeStatistics> distribute_points(const AppendInputs& inputs, const AppendPlan& plan,
                                                     const BuildFrame& frame, PartStore& store, StageClock& clock,
                                                     estimation::SurfelReport& report);

}  // namespace surfcast::builder
