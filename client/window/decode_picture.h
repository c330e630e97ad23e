#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::window {

/// A picture to be shown: rows from the top, four bytes per pixel, blue, green, red and one that is not looked at.
struct PixelImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;
};

/// The pixels of a PNG or JPEG file. A server is not trusted: sides beyond 16384 pixels are refused.
Result<PixelImage> decode_picture(const wire::Picture& picture);

}  // namespace surfcast::window
