#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::window {

/// A decoded picture: rows from the top, four bytes per pixel: blue, green, red, and an unused byte.
struct PixelImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;
};

/// The pixels of a PNG or JPEG file. The server is not trusted: pictures wider or higher than 16384 pixels are refused.
Result<PixelImage> decode_picture(const wire::Picture& picture);

}  // namespace surfcast::window
