// The module that encodes video with libvpx; video_stream.cpp loads it.
#include <algorithm>
#include <string>
#include <utility>

#include <vpx/vp8cx.h>
#include <vpx/vpx_encoder.h>

#include "video/codec_module.h"
#include "video/planes.h"

namespace surfcast::video {

struct Encoder {
  Encoder(int width, int height) : blank{width, height, picture::PixelFormat::kSrgb8, {}} {}
  ~Encoder() {
    if (open) vpx_codec_destroy(&codec);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  picture::Image blank;  ///< of the largest size; without pixels once the codec is open
  vpx_codec_ctx_t codec{};
  vpx_codec_enc_cfg_t config{};
  Planes planes;
  bool open = false;
  int64_t pictures = 0;
  /// Of the pictures since the last key frame, pixels.
  unsigned largest_width = 0;
  unsigned largest_height = 0;
};

namespace {

constexpr int kSpeed = 8;  // 9 is a tenth or so faster and 0.3 dB worse; 7 is a quarter slower and 0.1 dB better

tl::unexpected<Error> codec_error(Encoder& encoder, const char* step) {
  const char* detail = vpx_codec_error_detail(&encoder.codec);
  return fail(ErrorKind::kInternal,
              std::string("libvpx: ") + step + ": " + (detail != nullptr ? detail : vpx_codec_error(&encoder.codec)));
}

/// One thread, nothing held back, and the quantizer is the caller's.
vpx_codec_enc_cfg_t make_config() {
  constexpr int kMilliseconds = 1000;
  vpx_codec_enc_cfg_t config{};
  vpx_codec_enc_config_default(vpx_codec_vp9_cx(), &config, 0);
  config.g_threads = 1;
  config.g_lag_in_frames = 0;
  config.g_timebase = {1, kMilliseconds};
  config.rc_end_usage = VPX_CBR;
  config.rc_dropframe_thresh = 0;
  config.rc_resize_allowed = 0;
  config.kf_mode = VPX_KF_DISABLED;
  return config;
}

vpx_image_t wrap(Planes& planes) {
  vpx_image_t image{};
  vpx_img_wrap(&image, VPX_IMG_FMT_I420, static_cast<unsigned>(planes.width), static_cast<unsigned>(planes.height), 1,
               planes.luma.data());
  image.cs = VPX_CS_BT_709;
  image.range = VPX_CR_STUDIO_RANGE;
  image.planes[VPX_PLANE_U] = planes.blue.data();
  image.planes[VPX_PLANE_V] = planes.red.data();
  image.stride[VPX_PLANE_Y] = planes.width;
  image.stride[VPX_PLANE_U] = image.stride[VPX_PLANE_V] = half_of(planes.width);
  return image;
}

Result<CodedPicture> take_packet(Encoder& encoder) {
  CodedPicture coded;
  vpx_codec_iter_t iterator = nullptr;
  while (const vpx_codec_cx_pkt_t* packet = vpx_codec_get_cx_data(&encoder.codec, &iterator)) {
    if (packet->kind != VPX_CODEC_CX_FRAME_PKT) continue;
    const auto* bytes = static_cast<const std::byte*>(packet->data.frame.buf);
    coded.bytes.insert(coded.bytes.end(), bytes, bytes + packet->data.frame.sz);
    coded.key = (packet->data.frame.flags & VPX_FRAME_IS_KEY) != 0;
  }
  if (coded.bytes.empty()) return fail(ErrorKind::kInternal, "libvpx: no packet");
  return coded;
}

Result<CodedPicture> encode_planes(Encoder& encoder, const picture::Image& image, bool key) {
  constexpr unsigned long kDuration = 33;  // ms; without effect on pictures of a given quantizer
  fill_planes(image, encoder.planes);
  const vpx_image_t planes = wrap(encoder.planes);
  const vpx_codec_pts_t time = encoder.pictures++ * static_cast<int64_t>(kDuration);
  const vpx_enc_frame_flags_t flags = key ? VPX_EFLAG_FORCE_KF : 0;
  if (vpx_codec_encode(&encoder.codec, &planes, time, kDuration, flags, VPX_DL_REALTIME) != VPX_CODEC_OK) {
    return codec_error(encoder, "encode");
  }
  return take_packet(encoder);
}

/// libvpx 1.12 sizes its buffers by its first picture, and writes beyond some of them where a later one is larger. So
/// the first one is blank, has the largest size and is not sent.
Status open_codec(Encoder& encoder) {
  picture::Image blank = std::move(encoder.blank);
  encoder.config = make_config();
  encoder.config.g_w = static_cast<unsigned>(blank.width);
  encoder.config.g_h = static_cast<unsigned>(blank.height);
  if (vpx_codec_enc_init(&encoder.codec, vpx_codec_vp9_cx(), &encoder.config, 0) != VPX_CODEC_OK) {
    return codec_error(encoder, "init");
  }
  encoder.open = true;
  vpx_codec_control(&encoder.codec, VP8E_SET_CPUUSED, kSpeed);
  vpx_codec_control(&encoder.codec, VP9E_SET_AQ_MODE, 0);
  vpx_codec_control(&encoder.codec, VP9E_SET_COLOR_SPACE, VPX_CS_BT_709);
  vpx_codec_control(&encoder.codec, VP9E_SET_COLOR_RANGE, VPX_CR_STUDIO_RANGE);
  blank.pixels.resize(static_cast<size_t>(blank.width) * static_cast<size_t>(blank.height) * 4);
  return encode_planes(encoder, blank, /*key=*/true).map([](const CodedPicture&) {});
}

Status configure(Encoder& encoder, unsigned width, unsigned height, int quantizer) {
  if (!encoder.open) {
    if (Status status = open_codec(encoder); !status) return status;
  }
  encoder.config.g_w = width;
  encoder.config.g_h = height;
  encoder.config.rc_min_quantizer = encoder.config.rc_max_quantizer = static_cast<unsigned>(quantizer);
  if (vpx_codec_enc_config_set(&encoder.codec, &encoder.config) != VPX_CODEC_OK) return codec_error(encoder, "config");
  return {};
}

/// Whether a picture of this size may refer to the ones before. VP9 refers to pictures of at most twice the size.
bool may_refer(const Encoder& encoder, unsigned width, unsigned height) {
  return encoder.largest_width > 0 && encoder.largest_width <= 2 * width && encoder.largest_height <= 2 * height;
}

Result<CodedPicture> encode_image(Encoder& encoder, const picture::Image& image, int quantizer, bool key) {
  const auto width = static_cast<unsigned>(image.width);
  const auto height = static_cast<unsigned>(image.height);
  const bool begins = key || !may_refer(encoder, width, height);
  if (Status status = configure(encoder, width, height, quantizer); !status) return fail(status);
  Result<CodedPicture> coded = encode_planes(encoder, image, begins);
  if (!coded) return coded;
  encoder.largest_width = coded->key ? width : std::max(encoder.largest_width, width);
  encoder.largest_height = coded->key ? height : std::max(encoder.largest_height, height);
  return coded;
}

Encoder* create_encoder(int width, int height) {
  return new Encoder(width, height);
}

void destroy_encoder(Encoder* encoder) {
  delete encoder;
}

void encode_into(Encoder& encoder, const picture::Image& image, int quantizer, bool key, Result<CodedPicture>& coded) {
  coded = encode_image(encoder, image, quantizer, key);
}

}  // namespace
}  // namespace surfcast::video

const surfcast::video::VideoFunctions* surfcast_video_codec() {
  static constexpr surfcast::video::VideoFunctions kFunctions{
      surfcast::video::create_encoder, surfcast::video::destroy_encoder, surfcast::video::encode_into};
  return &kFunctions;
}
