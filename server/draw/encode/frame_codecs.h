#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "picture/file_format.h"
#include "picture/picture.h"

namespace surfcast::encode {

// The files of 8-bit colours: PNG, JPEG and WebP. The images have the format kSrgb8 and sides that the file formats
// allow; alpha is left out.

/// Lossless, by libpng.
Result<std::vector<std::byte>> encode_png(const picture::Image& image);
/// With colours at half the resolution (4:2:0), by libjpeg-turbo. `quality`: 1 to 100.
Result<std::vector<std::byte>> encode_jpeg(const picture::Image& image, int quality, picture::JpegOrder order);
/// Lossy, by libwebp. `quality`: 1 to 100.
Result<std::vector<std::byte>> encode_webp(const picture::Image& image, int quality);

}  // namespace surfcast::encode
