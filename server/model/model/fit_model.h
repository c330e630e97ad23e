#pragma once

#include "geometry/camera.h"
#include "model/model_file.h"

namespace surfcast::model {

/// A camera that shows the whole model, from the side that most of its normals face. `aspect` is the picture's width
/// over its height.
geometry::Camera fit_model(const ModelFile& model, double aspect);

}  // namespace surfcast::model
