#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "builder/memory_budget.h"
#include "builder/part_finder.h"
#include "builder/part_plan.h"
#include "builder/part_store.h"
#include "builder/stage_clock.h"
#include "estimation/surfel_report.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// Called for every piece that is read to plan the parts, from any thread, for some pieces several times.
using SeePiece = std::function<void(size_t piece, const InputPiece& read, const estimation::SurfelReport& report)>;

/// Into how many parts points are divided.
struct Division {
  MemoryPlan memory;            ///< its parts
  std::optional<size_t> parts;  ///< exactly so many instead
};

/// Counts the points in octree cells and plans the parts. A single part is planned without reading any point. Fails
/// with kLimit if the points cannot be divided into as many parts as are wanted.
Result<std::vector<Part>> divide_points(const BuildInputs& inputs, const geometry::RootCube& root,
                                        const Division& division, StageClock& clock, const SeePiece& see);

/// Reads pieces of the inputs and adds their points to the parts that need them, in the order of the pieces. `only`:
/// the one part that is wanted; none: all of them.
Status distribute_points(const BuildInputs& inputs, std::span<const size_t> pieces, const PartFinder& finder,
                         const geometry::RootCube& root, std::optional<uint32_t> only, PartStore& store,
                         StageClock& clock, estimation::SurfelReport& report);

}  // namespace surfcast::builder
