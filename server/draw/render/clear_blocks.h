#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/model_file.h"
#include "render/volume_plan.h"

namespace surfcast::render {

/// For each block of a model: true if the transfer function, iso-surfaces and slices show nothing of it and of its
/// descendants. Only bricks of volumes can be clear. Empty for models without volumes.
std::vector<bool> clear_blocks(const model::ModelFile& model, const VolumeLook& look);

/// For each block of a model: true if the picture shows nothing of it and of its descendants, because it is clear or of
/// a member that is hidden. Empty if all may show.
std::vector<bool> hidden_blocks(const model::ModelFile& model, const VolumeLook& look,
                                std::span<const std::string> hidden_models);

}  // namespace surfcast::render
