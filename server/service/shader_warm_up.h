#pragma once

#include <vector>

#include "model/model_file.h"
#include "picture/picture.h"

namespace surfcast::service {

/// Tiny pictures that need, one after another, all the programs that a viewer of the model is likely to ask for:
/// drivers compile a program when it is first used, which can take seconds. The likeliest come first.
std::vector<picture::PictureRequest> shader_warm_up_requests(const model::ModelInfo& info);

}  // namespace surfcast::service
