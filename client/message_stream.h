#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast::client {

/// How messages lie in the stream of bytes of a connection. Sends and receives nothing itself.
class MessageStream {
 public:
  using Bytes = std::vector<std::byte>;

  virtual ~MessageStream() = default;

  /// What to send for a message.
  virtual Bytes encode(std::span<const std::byte> message) = 0;
  /// Takes what has arrived.
  virtual void append(std::span<const std::byte> bytes) = 0;
  /// The next whole message, nothing while it is incomplete, or an error after which the stream is of no use.
  virtual Result<std::optional<Bytes>> next() = 0;
  /// What the stream itself has to say since this was last asked.
  virtual Bytes take_replies() = 0;
};

/// Each message after its length.
std::unique_ptr<MessageStream> make_framed_stream();

}  // namespace surfcast::client
