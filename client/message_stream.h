#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast::client {

/// Encodes messages into the byte stream of a connection, and decodes them. Does no input or output itself.
class MessageStream {
 public:
  using Bytes = std::vector<std::byte>;

  virtual ~MessageStream() = default;

  /// The bytes to send for a message.
  virtual Bytes encode(std::span<const std::byte> message) = 0;
  /// Adds received bytes.
  virtual void append(std::span<const std::byte> bytes) = 0;
  /// The next complete message; nothing while it is incomplete. After an error the stream is no longer usable.
  virtual Result<std::optional<Bytes>> next() = 0;
  /// Bytes that the transport itself must send, such as WebSocket pongs, since the last call.
  virtual Bytes take_replies() = 0;
};

/// The framed protocol: each message follows its length.
std::unique_ptr<MessageStream> make_framed_stream();

}  // namespace surfcast::client
