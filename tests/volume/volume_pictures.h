#pragma once

#include "geometry/camera.h"
#include "picture/picture.h"
#include "reference/light_picture.h"

namespace surfcast::testing {

/// The pixels of a picture of floats.
reference::LightPicture light_of(const picture::Image& image);

/// A request of floats from a place in the direction of another.
picture::PictureRequest request_of(const geometry::CameraFrame& frame);

/// The mean opacity of the pixels.
double mean_opacity(const reference::LightPicture& picture);

}  // namespace surfcast::testing
