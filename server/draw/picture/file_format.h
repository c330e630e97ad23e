#pragma once

#include "picture/picture.h"

namespace surfcast::picture {

enum class FileFormat { kPng, kJpeg, kWebp, kExr };

/// The pixel format in which a picture is rendered for a file format: linear light for EXR, sRGB for the others.
[[nodiscard]] inline PixelFormat pixel_format_of(FileFormat format) {
  return format == FileFormat::kExr ? PixelFormat::kLinearFloat : PixelFormat::kSrgb8;
}

}  // namespace surfcast::picture
