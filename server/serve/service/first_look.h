#pragma once

#include "model/model_file.h"
#include "picture/picture.h"

namespace surfcast::service {

/// The picture that a request asks for, with what it leaves open (Shading::kAuto and the colours of the scan): surfels
/// of a model without colours are coloured by their intensity, in grey, or else by their elevation, are lit, and have
/// eye-dome lighting. Models with colours, of meshes, and of other kinds stay as they are.
picture::PictureRequest with_first_look(picture::PictureRequest request, const model::ModelInfo& info);

}  // namespace surfcast::service
