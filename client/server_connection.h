#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "client/message_stream.h"
#include "protocol/endpoint.h"
#include "protocol/hello.h"
#include "surfcast.pb.h"

namespace surfcast::client {

struct ClientConfig {
  std::chrono::milliseconds connect{10'000};  ///< for the connection and both hellos
  std::chrono::milliseconds answer{120'000};  ///< for one complete answer
  int interrupt = -1;                         ///< descriptor that becomes readable to end a wait; -1: none
};

/// A connection to a server after the exchange of hellos, framed or by WebSocket as the endpoint states. Calls block;
/// every wait has a timeout. Errors name the server.
class ServerConnection {
 public:
  static Result<ServerConnection> open(const protocol::Endpoint& server, const ClientConfig& config);

  ServerConnection(ServerConnection&& other) noexcept;
  ServerConnection& operator=(ServerConnection&&) = delete;
  ~ServerConnection();

  /// Sends a request with a new id; returns the id.
  Result<uint64_t> send(wire::Request request);
  /// Sends a request with an existing id: a message to a view.
  Status send_as(uint64_t id, wire::Request request);
  /// The next answer, with any id. kCancelled when interrupted.
  Result<wire::Answer> receive();
  /// The same, but nothing if no answer is complete by `deadline`.
  Result<std::optional<wire::Answer>> receive_until(std::chrono::steady_clock::time_point deadline);
  /// Sends a request and waits for its answer. An error answer is returned as an error. When interrupted, asks the
  /// server to cancel the request.
  Result<wire::Answer> ask(wire::Request request);

  /// Bytes received since the connection was opened.
  [[nodiscard]] uint64_t bytes_received() const { return bytes_received_; }
  /// An error that names the server.
  [[nodiscard]] tl::unexpected<Error> failed(ErrorKind kind, const std::string& what) const;
  /// The server's hello.
  [[nodiscard]] const protocol::Hello& server() const { return server_; }

 private:
  using Clock = std::chrono::steady_clock;

  ServerConnection(int descriptor, const protocol::Endpoint& server, const ClientConfig& config);
  Status exchange_hellos(Clock::time_point deadline);
  Result<std::vector<std::byte>> greet_framed(Clock::time_point deadline);
  Result<std::vector<std::byte>> greet_websocket(Clock::time_point deadline);
  Status upgrade(Clock::time_point deadline);
  Result<std::optional<wire::Answer>> next_answer();
  Status wait(short events, Clock::time_point deadline) const;
  Status write_all(std::span<const std::byte> bytes, Clock::time_point deadline);
  Result<size_t> read_some(std::span<std::byte> bytes, Clock::time_point deadline);
  Status read_all(std::span<std::byte> bytes, Clock::time_point deadline);

  int descriptor_;
  protocol::Endpoint endpoint_;
  ClientConfig config_;
  protocol::Hello server_;
  std::unique_ptr<MessageStream> stream_;
  std::vector<std::byte> buffer_;
  uint64_t bytes_received_ = 0;
  uint64_t last_id_ = 0;
};

}  // namespace surfcast::client
