#pragma once

#include "geometry/camera.h"
#include "model/model_file.h"

namespace surfcast::model {

/// A view that shows the whole model, from where most of its surface shows its front; `aspect` is the picture's width
/// over its height.
geometry::Camera fit_model(const ModelFile& model, double aspect);

}  // namespace surfcast::model
