#include "encode/encode_picture.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/contract.h"
#include "base/load_module.h"
#include "encode/codec_module.h"
#include "encode/frame_codecs.h"

namespace surfcast::encode {
namespace {

/// Loads the module that uses OpenImageIO. The library depends on some 250 others, which take longer to load than
/// everything else at start. So only pictures as EXR load it.
Result<EncodeFunction*> load_exr_codec() {
  return load_function(kCodecModule, kEncodeSymbol)
      .map([](void* function) { return reinterpret_cast<EncodeFunction*>(function); })
      .map_error([](const Error& error) {
        return Error{error.kind, "the codec of EXR: " + error.message};
      });
}

/// Longest side of a picture in this file format, pixels. The libraries have limits of their own, and messages that
/// tell less.
int largest_side(picture::FileFormat format) {
  switch (format) {
    case picture::FileFormat::kJpeg:
      return 65500;
    case picture::FileFormat::kWebp:
      return 16383;
    case picture::FileFormat::kPng:
      return 1'000'000;  // libpng's own limit
    case picture::FileFormat::kExr:
      break;
  }
  return std::numeric_limits<int>::max();
}

Result<std::vector<std::byte>> encode_exr(const picture::Image& image, const picture::Channels* channels) {
  static const Result<EncodeFunction*> codec = load_exr_codec();
  if (!codec) return fail(codec);
  Result<std::vector<std::byte>> bytes;
  (*codec)(image, channels, bytes);
  return bytes;
}

}  // namespace

Result<std::vector<std::byte>> encode_picture(const picture::Image& image, picture::FileFormat format, int quality,
                                              picture::JpegOrder order, const picture::Channels* channels) {
  SURFCAST_EXPECTS(channels == nullptr || format == picture::FileFormat::kExr);
  SURFCAST_EXPECTS(image.width > 0 && image.height > 0 && image.format == picture::pixel_format_of(format));
  SURFCAST_EXPECTS(image.pixels.size() ==
                   bytes_per_pixel(image.format) * static_cast<size_t>(image.width) * image.height);
  if (std::max(image.width, image.height) > largest_side(format)) {
    return fail(ErrorKind::kLimit, "a side of more than " + std::to_string(largest_side(format)) +
                                       " pixels cannot be stored in this file format");
  }
  switch (format) {
    case picture::FileFormat::kPng:
      return encode_png(image);
    case picture::FileFormat::kJpeg:
      return encode_jpeg(image, quality, order);
    case picture::FileFormat::kWebp:
      return encode_webp(image, quality);
    case picture::FileFormat::kExr:
      break;
  }
  return encode_exr(image, channels);
}

}  // namespace surfcast::encode
