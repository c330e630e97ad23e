#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "client/message_stream.h"

namespace surfcast::client {

/// The request by which a connection becomes a WebSocket, and what its answer must hold (RFC 6455, section 4).
struct WebSocketHandshake {
  std::string request;
  std::string expected_accept;

  /// `host` as in the URL, `key` 16 bytes that nobody can foresee.
  static WebSocketHandshake make(const std::string& host, std::string_view key);
  /// Whether the header of an answer of HTTP grants the WebSocket; the error repeats what the server said.
  [[nodiscard]] Status check(std::string_view answer) const;
};

/// The messages of a WebSocket, seen from the client: each one is binary. Pings are answered; the server's goodbye is
/// an error. Beast could do it as well, but would bring Asio into a client that waits for one socket with poll(2), and
/// many times its size.
std::unique_ptr<MessageStream> make_websocket_stream();

}  // namespace surfcast::client
