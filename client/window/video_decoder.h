#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "base/result.h"
#include "client/window/decode_picture.h"
#include "surfcast.pb.h"

struct vpx_codec_ctx;

namespace surfcast::window {

/// Decodes the packets of a view's video (wire::VideoPacket).
class VideoDecoder {
 public:
  /// The pixels of the next packet. Fails if it is damaged; the next one to be decoded is then a key frame. Pictures
  /// wider or higher than 16384 pixels are refused.
  Result<PixelImage> decode(std::string_view packet);
  /// Likewise, of a frame. Fails if it is not the one that follows what was decoded last.
  Result<PixelImage> decode(const wire::ViewFrame& frame);

 private:
  using Codec = std::unique_ptr<vpx_codec_ctx, void (*)(vpx_codec_ctx*)>;
  static void destroy(vpx_codec_ctx* codec);
  Status begin();

  Codec codec_{nullptr, &destroy};
  uint64_t last_frame_ = 0;  ///< 0: none
};

/// The pixels of any frame: of its file, or of the next packet of the video.
Result<PixelImage> decode_frame(const wire::ViewFrame& frame, VideoDecoder& video);

}  // namespace surfcast::window
