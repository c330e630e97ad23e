#pragma once

#include <vector>

#include "model/model_file.h"
#include "render/picture.h"

namespace surfcast {

/// Tiny pictures that need, one after another, all the programs that a viewer of the model is likely to ask for:
/// drivers compile a program when it is first used, which can take seconds. The likeliest come first.
std::vector<PictureRequest> rehearsal_of(const ModelInfo& info);

}  // namespace surfcast
