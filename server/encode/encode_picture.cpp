#include "encode/encode_picture.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/contract.h"
#include "base/load_module.h"
#include "encode/codec_module.h"

namespace surfcast::encode {
namespace {

/// Loads the module that uses OpenImageIO. The library depends on some 250 others, which take longer to load than
/// everything else at start. So commands that encode nothing do not load it.
Result<EncodeFunction*> load_codecs() {
  return load_function(kCodecModule, kEncodeSymbol)
      .map([](void* function) { return reinterpret_cast<EncodeFunction*>(function); })
      .map_error([](const Error& error) {
        return Error{error.kind, "the image codecs: " + error.message};
      });
}

/// Longest side of a picture in this file format, pixels. It is checked before encoding because libjpeg would otherwise
/// terminate the process.
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

const Result<EncodeFunction*>& codecs() {
  static const Result<EncodeFunction*> loaded = load_codecs();
  return loaded;
}

}  // namespace

Status prepare_encoding() {
  return codecs() ? Status() : fail(codecs().error());
}

Result<std::vector<std::byte>> encode_picture(const picture::Image& image, picture::FileFormat format, int quality,
                                              const picture::Channels* channels) {
  SURFCAST_EXPECTS(channels == nullptr || format == picture::FileFormat::kExr);
  SURFCAST_EXPECTS(image.width > 0 && image.height > 0 && image.format == picture::pixel_format_of(format));
  SURFCAST_EXPECTS(image.pixels.size() ==
                   bytes_per_pixel(image.format) * static_cast<size_t>(image.width) * image.height);
  if (std::max(image.width, image.height) > largest_side(format)) {
    return fail(ErrorKind::kLimit, "a side of more than " + std::to_string(largest_side(format)) +
                                       " pixels cannot be stored in this file format");
  }
  if (!codecs()) return fail(codecs().error());
  Result<std::vector<std::byte>> bytes;
  (*codecs())(image, format, quality, channels, bytes);
  return bytes;
}

}  // namespace surfcast::encode
