#pragma once

#include <chrono>
#include <optional>

#include "base/descriptor.h"
#include "base/result.h"
#include "worker/messages.h"

namespace surfcast::worker {

/// A message, and the file descriptor that came with it.
struct Received {
  Message message;
  Descriptor descriptor{};
};

/// One end of a pair of connected Unix sockets over which messages and file descriptors travel. Used by one thread.
class Channel {
 public:
  /// Both ends.
  static Result<std::pair<Channel, Channel>> make_pair();
  explicit Channel(Descriptor socket) : socket_(std::move(socket)) {}

  /// Waits until all of it is under way. kIo when the other end has gone, or takes nothing for `kPatience`.
  Status send(const Message& message, int descriptor = -1);
  /// The next message, or none if none begins within this time. kIo when the other end has gone, or stops in the middle
  /// of a message; kInvalidInput when what comes is no message.
  Result<std::optional<Received>> receive(std::chrono::milliseconds most);

  [[nodiscard]] const Descriptor& socket() const { return socket_; }

 private:
  Status read_all(std::span<std::byte> bytes, Descriptor* descriptor);

  Descriptor socket_;
};

}  // namespace surfcast::worker
