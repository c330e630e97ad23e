#include "gaussian/sog_picture.h"

#include <webp/decode.h>

namespace surfcast::gaussian {
namespace {

constexpr int kLossless = 2;  // WebPBitstreamFeatures::format

}  // namespace

Result<SogPicture> webp_size(std::span<const std::byte> file) {
  WebPBitstreamFeatures features;
  const auto* bytes = reinterpret_cast<const uint8_t*>(file.data());
  if (WebPGetFeatures(bytes, file.size(), &features) != VP8_STATUS_OK) {
    return fail(ErrorKind::kInvalidInput, "not a WebP picture");
  }
  if (features.has_animation != 0 || features.format != kLossless) {
    return fail(ErrorKind::kInvalidInput, "not a lossless picture: its bytes are not the numbers that were stored");
  }
  return SogPicture{static_cast<uint64_t>(features.width), static_cast<uint64_t>(features.height), {}};
}

Result<SogPicture> decode_webp(std::span<const std::byte> file) {
  Result<SogPicture> picture = webp_size(file);
  if (!picture) return picture;
  picture->bytes.resize(picture->pixels() * 4);
  const auto* bytes = reinterpret_cast<const uint8_t*>(file.data());
  const auto stride = static_cast<int>(picture->width * 4);
  if (WebPDecodeRGBAInto(bytes, file.size(), picture->bytes.data(), picture->bytes.size(), stride) == nullptr) {
    return fail(ErrorKind::kInvalidInput, "truncated or damaged picture");
  }
  return picture;
}

}  // namespace surfcast::gaussian
