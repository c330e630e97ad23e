#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "protocol/endpoint.h"

namespace surfcast::client {

/// Whole messages over one TCP connection to a server. Every call blocks until its deadline at most: kUnavailable then,
/// kCancelled when the interrupt comes first. After these two the channel is still good, and the next call goes on with
/// what had begun; after any other error it is of no use.
class MessageChannel {
 public:
  using Bytes = std::vector<std::byte>;
  using TimePoint = std::chrono::steady_clock::time_point;

  virtual ~MessageChannel() = default;

  /// Sends the first message and returns the server's. To be called once, before anything else.
  virtual Result<Bytes> exchange_hellos(std::span<const std::byte> hello, TimePoint deadline) = 0;
  virtual Status write(std::span<const std::byte> message, TimePoint deadline) = 0;
  virtual Result<Bytes> read(TimePoint deadline) = 0;
};

/// Connects to a server: a WebSocket or the framed protocol, as the endpoint says. `interrupt`, `ca`
/// and `model` are as in ClientConfig.
Result<std::unique_ptr<MessageChannel>> connect_channel(const protocol::Endpoint& server,
                                                        MessageChannel::TimePoint deadline, int interrupt,
                                                        const std::string& ca, const std::string& model);

class ClientSocket;

/// Each message after its length. The socket is connected.
std::unique_ptr<MessageChannel> make_framed_channel(std::unique_ptr<ClientSocket> socket);
/// Each message one binary message of a WebSocket, which is asked for with the hellos. `host` and `target` are as in a
/// URL.
std::unique_ptr<MessageChannel> make_websocket_channel(std::unique_ptr<ClientSocket> socket, const std::string& host,
                                                       const std::string& target);

}  // namespace surfcast::client
