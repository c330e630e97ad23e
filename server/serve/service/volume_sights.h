#pragma once

#include <vector>

#include "kinds/volume_sight.h"
#include "model/model_file.h"
#include "picture/picture.h"

namespace surfcast::service {

/// What a picture shows of each volume of a model.
std::vector<kinds::VolumeSight> volume_sights(const model::ModelFile& model, const picture::PictureRequest& request);

}  // namespace surfcast::service
