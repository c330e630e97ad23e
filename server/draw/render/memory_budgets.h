#pragma once

#include <cstdint>
#include <optional>

#include "picture/device_info.h"

namespace surfcast::render {

/// What a machine has when the renderer starts, bytes.
struct MachineMemory {
  uint64_t host = 0;            ///< available to this process
  std::optional<uint64_t> gpu;  ///< free on the GPU; none: the GPU has no memory of its own, or the driver does not say
};

using picture::MemoryBudgets;

/// Budgets that leave room for all else.
///
/// GPU with memory of its own: a quarter of what is free. The largest user beside surfels are the records between the
/// passes of a frame, 60 bytes and some list entries per drawn splat against 16 bytes per stored surfel: with every
/// surfel of the budget in view, attributes and room to grow, they take three times the budget. Blocks in host memory
/// then take a quarter of what is available there: builds of models, decoding, encoding and the system's cache of the
/// model files have the rest.
///
/// Otherwise (pixels computed by the CPU, a GPU within the processor) all of this is host memory: an eighth for
/// surfels, by the same reckoning half with the records, and an eighth for blocks.
///
/// Never less than 64 MiB and 32 MiB, below which no scan of some size is sharp: a machine without that has no use for
/// a budget.
MemoryBudgets default_budgets(const MachineMemory& machine);

}  // namespace surfcast::render
