#pragma once

#include <span>

#include "ldc/block_tree.h"
#include "model/model_file.h"

namespace surfcast::model {

/// States in `info` what follows from the blocks of a model: levels, bounds, elevation, and the numbers of blocks and
/// items of each kind, whose names it has.
void count_blocks(std::span<const ldc::BlockEntry> blocks, ModelInfo& info);

}  // namespace surfcast::model
