#pragma once

#include <cstdint>

#include "base/result.h"
#include "builder/grid_input.h"
#include "builder/stage_clock.h"
#include "model/model_writer.h"

namespace surfcast::builder {

/// The memory that write_volume() takes, bytes; a double because sizes may be absurd.
[[nodiscard]] double volume_bytes(const GridInput& input);

/// Reads a measured grid once more and writes the bricks of all its levels. `number`: of the volume in the model.
Status write_volume(GridInput& input, uint32_t number, model::ModelWriter& writer, StageClock& clock);

}  // namespace surfcast::builder
