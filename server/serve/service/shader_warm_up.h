#pragma once

#include <vector>

#include "model/model_file.h"
#include "picture/picture.h"

namespace surfcast::service {

/// Tiny pictures that together use all the programs that a viewer of the model is likely to need, the likeliest first.
/// Drivers compile a program at its first use, which can take seconds.
std::vector<picture::PictureRequest> shader_warm_up_requests(const model::ModelFile& model);

}  // namespace surfcast::service
