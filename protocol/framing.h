#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"

namespace google::protobuf {
class MessageLite;
}

namespace surfcast::protocol {

/// Bytes of the length that goes before every message.
inline constexpr size_t kFrameHeaderBytes = 4;
/// Largest message of a client: requests are small.
inline constexpr size_t kMaxRequestBytes = size_t{64} << 10;
/// Largest message of a server: the largest picture it agrees to draw, uncompressed, and room to spare.
inline constexpr size_t kMaxAnswerBytes = size_t{512} << 20;

/// The length announced by a frame's header, checked against the limit before anyone allocates for it.
Result<size_t> frame_length(std::span<const std::byte, kFrameHeaderBytes> header, size_t limit);

/// What goes before a message of that length, which is within a limit.
std::array<std::byte, kFrameHeaderBytes> frame_header(size_t length);

/// A message alone. Fails when it is larger than `limit`.
Result<std::vector<std::byte>> encode_message(const google::protobuf::MessageLite& message, size_t limit);
/// A message with its length before it. Fails when it is larger than `limit`.
Result<std::vector<std::byte>> encode_frame(const google::protobuf::MessageLite& message, size_t limit);

/// Fills `message` from the bytes of one frame, header left out.
Status decode_message(std::span<const std::byte> bytes, google::protobuf::MessageLite& message);

/// Cuts a stream of bytes, arriving in pieces of any size, into the contents of frames. Memory grows with the bytes
/// that have arrived, never with the length that a frame announces.
class FrameSplitter {
 public:
  explicit FrameSplitter(size_t limit) : limit_(limit) {}

  void append(std::span<const std::byte> bytes);
  /// The next whole frame, nothing while it is incomplete, or an error after which the stream is of no use.
  Result<std::optional<std::vector<std::byte>>> next();
  /// Bytes of a frame have arrived that is not whole yet.
  [[nodiscard]] bool inside_frame() const { return start_ < buffer_.size(); }

 private:
  size_t limit_;
  std::vector<std::byte> buffer_;
  size_t start_ = 0;  ///< bytes of buffer_ that have been handed out
};

}  // namespace surfcast::protocol
