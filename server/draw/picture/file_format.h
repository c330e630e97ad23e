#pragma once

#include "picture/picture.h"

namespace surfcast::picture {

enum class FileFormat { kPng, kJpeg, kWebp, kExr };

/// The order of the data of a JPEG file. Both orders have the same pixels.
enum class JpegOrder {
  kRows,   ///< from the upper edge to the lower one
  kScans,  ///< coarse to fine, each time of the whole picture (progressive): fewer bytes, three times the time
};

/// The pixel format in which a picture is rendered for a file format: linear light for EXR, sRGB for the others.
[[nodiscard]] inline PixelFormat pixel_format_of(FileFormat format) {
  return format == FileFormat::kExr ? PixelFormat::kLinearFloat : PixelFormat::kSrgb8;
}

}  // namespace surfcast::picture
