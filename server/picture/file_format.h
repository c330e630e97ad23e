#pragma once

#include "picture/picture.h"

namespace surfcast::picture {

enum class FileFormat { kPng, kJpeg, kWebp, kExr };

/// The pixel format that a picture is rendered in for a file format: EXR holds measured light, the others pictures.
[[nodiscard]] inline PixelFormat pixel_format_of(FileFormat format) {
  return format == FileFormat::kExr ? PixelFormat::kLinearFloat : PixelFormat::kSrgb8;
}

}  // namespace surfcast::picture
