#pragma once

#include <vector>

#include "model/model_file.h"
#include "render/volume_plan.h"

namespace surfcast::render {

/// For each block of a model: true if the transfer function, iso-surfaces and slices show nothing of it and of its
/// descendants. Only bricks of volumes can be clear. Empty for models without volumes.
std::vector<bool> clear_blocks(const model::ModelFile& model, const VolumeLook& look);

}  // namespace surfcast::render
