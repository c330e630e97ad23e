#pragma once

#include "picture/picture.h"
#include "reference/linear_picture.h"

namespace surfcast::lab {

using reference::SrgbPicture;

/// The colours of a picture in PixelFormat::kSrgb8.
SrgbPicture picture_of(const picture::Image& image);

}  // namespace surfcast::lab
