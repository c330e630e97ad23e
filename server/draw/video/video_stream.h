#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "picture/picture.h"
#include "video/codec_module.h"
#include "video/quantizer.h"

namespace surfcast::video {

/// A frame of a view as a part of its video.
struct VideoPacket {
  std::vector<std::byte> bytes;
  bool key = false;        ///< a decoder can begin here
  uint64_t refers_to = 0;  ///< the frame that was encoded before; 0 if `key`
};

/// What a frame of a view is encoded as.
struct FrameOrder {
  uint64_t frame = 0;  ///< its number, increasing
  size_t bytes = 0;    ///< wanted; a key frame takes up to three times as many
  /// Of the view, pixels: larger frames are unlikely.
  int view_width = 0;
  int view_height = 0;
};

/// Encodes frames, one after another, as a VP9 stream: profile 0, BT.709 in limited range. A decoder needs all packets
/// since a key frame, in their order.
class VideoStream {
 public:
  /// Fails if the server has no module for it.
  static Result<std::shared_ptr<VideoStream>> open();

  /// Encodes an sRGB image of 8 bits. Called by one thread at a time. Fails with kLimit where the encoders of other
  /// streams leave no memory for one of this size.
  Result<VideoPacket> encode(const picture::Image& image, const FrameOrder& order);
  /// A packet does not reach the decoder: the next one to be encoded is a key frame. Called from any thread.
  void restart() { restart_ = true; }

 private:
  using EncoderPointer = std::unique_ptr<Encoder, std::function<void(Encoder*)>>;

  explicit VideoStream(const VideoFunctions& functions) : functions_(functions) {}
  Status make_room(int width, int height);
  Result<CodedPicture> encode_key(const picture::Image& image, size_t bytes);
  Result<CodedPicture> encode_next(const picture::Image& image, size_t bytes);
  Result<CodedPicture> encode_with(const picture::Image& image, int quantizer, bool key);
  void learn(int quantizer, double bytes, double pixels, bool key);

  const VideoFunctions& functions_;
  EncoderPointer encoder_;
  /// Of images that it takes, pixels.
  int most_width_ = 0;
  int most_height_ = 0;
  std::atomic<bool> restart_ = true;
  SizeModel key_sizes_ = kFirstKeySizes;
  std::optional<SizeModel> sizes_;  ///< of other frames; none before the first key frame
  double last_pixels_ = 0;          ///< of the last image
  uint64_t last_frame_ = 0;
};

}  // namespace surfcast::video
