#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "picture/channels.h"
#include "picture/picture.h"

namespace surfcast::encode {

/// Bytes per pixel of an Image in memory, which has four channels.
[[nodiscard]] inline size_t bytes_per_pixel(picture::PixelFormat format) {
  return 4 * (format == picture::PixelFormat::kLinearFloat ? sizeof(float) : 1);
}

/// The file of the module, in the folder lib/surfcast beside the program's folder.
inline constexpr const char* kCodecModule = "image_codecs.so";
/// The function that the module exports.
inline constexpr const char* kEncodeSymbol = "surfcast_encode_exr";
using EncodeFunction = void(const picture::Image& image, const picture::Channels* channels,
                            Result<std::vector<std::byte>>& bytes);

}  // namespace surfcast::encode

/// Exported by the module. Arguments as of encode_picture() for an EXR file.
extern "C" [[gnu::visibility("default")]] surfcast::encode::EncodeFunction surfcast_encode_exr;
