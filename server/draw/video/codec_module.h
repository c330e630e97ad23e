#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "picture/picture.h"

namespace surfcast::video {

/// One picture of a VP9 stream.
struct CodedPicture {
  std::vector<std::byte> bytes;
  bool key = false;  ///< a decoder can begin here
};

/// Quantizers of the codec, from the best picture to the smallest.
inline constexpr int kFinestQuantizer = 0;
inline constexpr int kCoarsestQuantizer = 63;

/// The file of the module, in the folder lib/surfcast beside the program's folder.
inline constexpr const char* kVideoModule = "video_codec.so";
/// The function that the module exports.
inline constexpr const char* kVideoSymbol = "surfcast_video_codec";

/// An encoder within the module.
struct Encoder;

/// What the module does. One encoder is used by one thread at a time.
struct VideoFunctions {
  /// An encoder for images of at most this size.
  Encoder* (*create)(int width, int height);
  void (*destroy)(Encoder* encoder);
  /// Adds an sRGB image of 8 bits to the stream. Without `key` it may refer to the images before; where its size does
  /// not allow that, or there are none, it is a key frame all the same. Fails if libvpx does.
  void (*encode)(Encoder& encoder, const picture::Image& image, int quantizer, bool key, Result<CodedPicture>& coded);
};
using VideoFunctionsOf = const VideoFunctions*();

}  // namespace surfcast::video

/// Exported by the module.
extern "C" [[gnu::visibility("default")]] surfcast::video::VideoFunctionsOf surfcast_video_codec;
