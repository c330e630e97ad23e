#include "client/window/video_decoder.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include <vpx/vp8dx.h>
#include <vpx/vpx_decoder.h>

namespace surfcast::window {
namespace {

constexpr unsigned kMaxVideoSide = 16384;  // pixels

tl::unexpected<Error> undecodable(const char* why) {
  return fail(ErrorKind::kInvalidInput, std::string("the server sent a video that cannot be decoded: ") + why);
}

uint8_t to_byte(int fixed) {
  constexpr int kBits = 16;
  return static_cast<uint8_t>(std::clamp((fixed + (1 << (kBits - 1))) >> kBits, 0, 255));
}

/// BT.709 in limited range, times 2^16.
void set_pixel(int luma, int to_blue, int to_red, uint8_t* pixel) {
  const int y = 76309 * (luma - 16);
  const int b = to_blue - 128;
  const int r = to_red - 128;
  pixel[0] = to_byte(y + 138438 * b);
  pixel[1] = to_byte(y - 13975 * b - 34925 * r);
  pixel[2] = to_byte(y + 117489 * r);
}

PixelImage pixels_of(const vpx_image_t& image) {
  const auto width = static_cast<size_t>(image.d_w);
  PixelImage pixels{static_cast<int>(image.d_w), static_cast<int>(image.d_h), {}};
  pixels.pixels.resize(width * image.d_h * 4);
  const auto row = [&image](int plane, size_t y) {
    return image.planes[plane] + static_cast<ptrdiff_t>(y) * image.stride[plane];
  };
  for (size_t y = 0; y < image.d_h; ++y) {
    const uint8_t* luma = row(VPX_PLANE_Y, y);
    const uint8_t* to_blue = row(VPX_PLANE_U, y / 2);
    const uint8_t* to_red = row(VPX_PLANE_V, y / 2);
    uint8_t* to = pixels.pixels.data() + y * width * 4;
    for (size_t x = 0; x < width; ++x) set_pixel(luma[x], to_blue[x / 2], to_red[x / 2], to + 4 * x);
  }
  return pixels;
}

/// The size that a key frame states, or the one before.
bool fits(std::string_view packet) {
  vpx_codec_stream_info_t info{};
  info.sz = sizeof info;
  const auto* data = reinterpret_cast<const uint8_t*>(packet.data());
  const auto size = static_cast<unsigned>(packet.size());
  if (vpx_codec_peek_stream_info(vpx_codec_vp9_dx(), data, size, &info) != VPX_CODEC_OK) return false;
  return info.w <= kMaxVideoSide && info.h <= kMaxVideoSide;
}

}  // namespace

void VideoDecoder::destroy(vpx_codec_ctx* codec) {
  vpx_codec_destroy(codec);
  delete codec;
}

Status VideoDecoder::begin() {
  auto codec = std::make_unique<vpx_codec_ctx>();
  if (vpx_codec_dec_init(codec.get(), vpx_codec_vp9_dx(), nullptr, 0) != VPX_CODEC_OK) return undecodable("no decoder");
  codec_ = Codec(codec.release(), &destroy);
  return {};
}

Result<PixelImage> VideoDecoder::decode(std::string_view packet) {
  if (!fits(packet)) return undecodable("its size");
  if (!codec_) {
    if (Status status = begin(); !status) return fail(status);
  }
  const auto* data = reinterpret_cast<const uint8_t*>(packet.data());
  vpx_codec_iter_t iterator = nullptr;
  const bool decoded =
      vpx_codec_decode(codec_.get(), data, static_cast<unsigned>(packet.size()), nullptr, 0) == VPX_CODEC_OK;
  const vpx_image_t* image = decoded ? vpx_codec_get_frame(codec_.get(), &iterator) : nullptr;
  const bool usable =
      image != nullptr && image->fmt == VPX_IMG_FMT_I420 && std::max(image->d_w, image->d_h) <= kMaxVideoSide;
  if (usable) return pixels_of(*image);
  codec_.reset();
  last_frame_ = 0;
  return undecodable("a packet");
}

Result<PixelImage> VideoDecoder::decode(const wire::ViewFrame& frame) {
  const wire::VideoPacket& video = frame.video();
  if (video.codec() != wire::VIDEO_CODEC_VP9) return undecodable("its codec");
  if (!video.key() && (last_frame_ == 0 || video.refers_to() != last_frame_)) return undecodable("a packet is missing");
  Result<PixelImage> image = decode(std::string_view(frame.picture().data()));
  if (image) last_frame_ = frame.frame();
  return image;
}

Result<PixelImage> decode_frame(const wire::ViewFrame& frame, VideoDecoder& video) {
  return frame.has_video() ? video.decode(frame) : decode_picture(frame.picture());
}

}  // namespace surfcast::window
