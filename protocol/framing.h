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

/// Size of a frame header: the message length as a 32 bit integer.
inline constexpr size_t kFrameHeaderBytes = 4;
/// Largest message from a client. Requests are small.
inline constexpr size_t kMaxRequestBytes = size_t{64} << 10;
/// Largest message from a server: the largest picture that a server draws, uncompressed, with a margin.
inline constexpr size_t kMaxAnswerBytes = size_t{512} << 20;

/// The message length in a header. kLimit when it exceeds `limit`, so that a caller checks before it allocates memory.
Result<size_t> frame_length(std::span<const std::byte, kFrameHeaderBytes> header, size_t limit);

/// The header of a message of `length` bytes, which must be within the limit.
std::array<std::byte, kFrameHeaderBytes> frame_header(size_t length);

/// Serializes a message without a header. Fails when it is larger than `limit`.
Result<std::vector<std::byte>> encode_message(const google::protobuf::MessageLite& message, size_t limit);

/// Parses the contents of one frame, without its header, into `message`.
Status decode_message(std::span<const std::byte> bytes, google::protobuf::MessageLite& message);

/// Splits a byte stream, received in pieces of any size, into the contents of its frames. Memory grows with the bytes
/// received, never with the length that a header states.
class FrameSplitter {
 public:
  explicit FrameSplitter(size_t limit) : limit_(limit) {}

  void append(std::span<const std::byte> bytes);
  /// The contents of the next complete frame; nothing while the frame is incomplete. After an error the stream is no
  /// longer usable.
  Result<std::optional<std::vector<std::byte>>> next();
  /// Whether there are bytes that next() has not returned.
  [[nodiscard]] bool begun() const { return start_ < buffer_.size(); }

 private:
  size_t limit_;
  std::vector<std::byte> buffer_;
  size_t start_ = 0;  ///< bytes of buffer_ already returned by next()
};

}  // namespace surfcast::protocol
