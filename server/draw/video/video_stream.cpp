#include "video/video_stream.h"

#include <algorithm>
#include <utility>

#include "base/contract.h"
#include "base/host_memory.h"
#include "base/load_module.h"

namespace surfcast::video {
namespace {

constexpr int kNoQuantizer = -1;

/// Pixels that the encoders of all views may have together. An encoder takes some 90 bytes for each, as long as its
/// view is open; an eighth of the host's memory is for them. Views beyond that get files. So it is not a setting:
/// nothing is refused.
class EncoderRoom {
 public:
  bool take(int64_t pixels) {
    if (taken_.fetch_add(pixels) + pixels <= most_) return true;
    give_back(pixels);
    return false;
  }
  void give_back(int64_t pixels) { taken_ -= pixels; }

 private:
  static constexpr int64_t kPixelBytes = 90;
  static constexpr int64_t kMin = int64_t{3840} * 2160;
  const int64_t most_ = std::max(static_cast<int64_t>(read_host_memory().available) / 8 / kPixelBytes, kMin);
  std::atomic<int64_t> taken_ = 0;
};

EncoderRoom& encoder_room() {
  static EncoderRoom room;
  return room;
}

Result<const VideoFunctions*> load_video_functions() {
  return load_function(kVideoModule, kVideoSymbol)
      .map([](void* function) { return reinterpret_cast<VideoFunctionsOf*>(function)(); })
      .map_error([](const Error& error) {
        return Error{error.kind, "the video codec: " + error.message};
      });
}

double pixels_of(const picture::Image& image) {
  return static_cast<double>(image.width) * image.height;
}

}  // namespace

Result<std::shared_ptr<VideoStream>> VideoStream::open() {
  static const Result<const VideoFunctions*> functions = load_video_functions();
  if (!functions) return fail(functions);
  return std::shared_ptr<VideoStream>(new VideoStream(**functions));
}

/// Another encoder where an image is larger than the present one takes.
Status VideoStream::make_room(int width, int height) {
  if (width <= most_width_ && height <= most_height_) return {};
  encoder_.reset();
  most_width_ = std::max(most_width_, width);
  most_height_ = std::max(most_height_, height);
  const int64_t pixels = static_cast<int64_t>(most_width_) * most_height_;
  if (!encoder_room().take(pixels)) {
    most_width_ = most_height_ = 0;
    return fail(ErrorKind::kLimit, "too many views have a video");
  }
  encoder_ = EncoderPointer(functions_.create(most_width_, most_height_),
                            [destroy = functions_.destroy, pixels](Encoder* encoder) {
                              destroy(encoder);
                              encoder_room().give_back(pixels);
                            });
  restart();
  return {};
}

Result<VideoPacket> VideoStream::encode(const picture::Image& image, const FrameOrder& order) {
  SURFCAST_EXPECTS(image.format == picture::PixelFormat::kSrgb8 && image.width > 0 && image.height > 0);
  const int width = std::max(image.width, order.view_width);
  if (Status room = make_room(width, std::max(image.height, order.view_height)); !room) return fail(room);
  const bool begins = restart_.exchange(false) || !sizes_;
  Result<CodedPicture> coded = begins ? encode_key(image, order.bytes) : encode_next(image, order.bytes);
  if (!coded) {
    restart();
    return fail(coded);
  }
  const uint64_t before = std::exchange(last_frame_, order.frame);
  return VideoPacket{std::move(coded->bytes), coded->key, coded->key ? 0 : before};
}

/// How large a key frame becomes is not known well beforehand. One that is too large, or far too small, is encoded
/// again: nothing refers to it yet.
Result<CodedPicture> VideoStream::encode_key(const picture::Image& image, size_t bytes) {
  constexpr double kLarger = 3;    // times the bytes of other frames
  constexpr double kEnough = 0.6;  // of them
  constexpr int kTries = 3;
  const double wanted = kLarger * static_cast<double>(bytes);
  Result<CodedPicture> coded;
  int before = kNoQuantizer;
  for (int i = 0; i < kTries; ++i) {
    const int quantizer = quantizer_for(key_sizes_, wanted, pixels_of(image));
    if (quantizer == before) break;
    before = quantizer;
    coded = encode_with(image, quantizer, /*key=*/true);
    if (!coded) break;
    const auto size = static_cast<double>(coded->bytes.size());
    if (size <= wanted && size >= kEnough * wanted) break;
  }
  return coded;
}

Result<CodedPicture> VideoStream::encode_next(const picture::Image& image, size_t bytes) {
  const SizeModel sizes = pixels_of(image) > last_pixels_ ? sizes_of_larger(*sizes_) : *sizes_;
  const int quantizer = quantizer_for(sizes, static_cast<double>(bytes), pixels_of(image));
  return encode_with(image, quantizer, /*key=*/false);
}

Result<CodedPicture> VideoStream::encode_with(const picture::Image& image, int quantizer, bool key) {
  Result<CodedPicture> coded;
  functions_.encode(*encoder_, image, quantizer, key, coded);
  if (coded) learn(quantizer, static_cast<double>(coded->bytes.size()), pixels_of(image), coded->key);
  return coded;
}

void VideoStream::learn(int quantizer, double bytes, double pixels, bool key) {
  last_pixels_ = pixels;
  if (!key) {
    sizes_ = learned(*sizes_, quantizer, bytes, pixels);
    return;
  }
  key_sizes_ = learned(key_sizes_, quantizer, bytes, pixels);
  if (!sizes_) sizes_ = sizes_after_key(quantizer, bytes, pixels);
}

}  // namespace surfcast::video
