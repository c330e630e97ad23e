#pragma once

#include <cstdint>

#include "base/result.h"
#include "model/model_file.h"
#include "volume/brick.h"

namespace surfcast::volume {

/// Reads and decodes a block of the kind "grid". Fails, naming file and block, if its bytes are no brick, or not the
/// one that the tables describe.
[[nodiscard]] Result<Brick> read_brick(const model::ModelFile& model, uint32_t block);

}  // namespace surfcast::volume
