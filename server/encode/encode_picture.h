#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "render/picture.h"

namespace surfcast {

enum class FileFormat { kPng, kJpeg, kWebp, kExr };

/// What a picture is rendered as for a file format: EXR holds measured light, the others pictures.
[[nodiscard]] inline PixelFormat pixel_format_of(FileFormat format) {
  return format == FileFormat::kExr ? PixelFormat::kLinearFloat : PixelFormat::kSrgb8;
}

/// The bytes of a file that holds the picture's three colours; coverage is left out, since the background is already
/// blended in. `quality` (1 to 100) matters to JPEG and WebP alone. The same image gives the same bytes. The image must
/// have the pixel format of the file format.
Result<std::vector<std::byte>> encode_picture(const Image& image, FileFormat format, int quality);

}  // namespace surfcast
