#pragma once

#include "model/model_file.h"
#include "picture/picture.h"
#include "render/display_options.h"
#include "render/programs.h"

namespace surfcast::render {

/// The features that a picture of a model asks for.
Variant variant_of(const model::ModelInfo& info, const DisplayOptions& display, const picture::PictureRequest& request);

}  // namespace surfcast::render
