#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "client/message_channel.h"
#include "protocol/endpoint.h"
#include "protocol/hello.h"
#include "surfcast.pb.h"

namespace surfcast::client {

struct ClientConfig {
  std::chrono::milliseconds connect{10'000};  ///< for the connection and both hellos
  std::chrono::milliseconds answer{120'000};  ///< for one complete answer
  int interrupt = -1;                         ///< descriptor that becomes readable to end a wait; -1: none
  std::string token{};                        ///< that is named to the server; empty: none
  std::string ca{};                           ///< certificates to trust, a PEM file; empty: those of the system
  std::string model{};                        ///< that will be asked for, so that proxies can choose a server by it
};

/// A connection to a server after the exchange of hellos, framed or by WebSocket as the endpoint states. Calls block;
/// every wait has a timeout. Errors name the server.
class ServerConnection {
 public:
  static Result<ServerConnection> open(const protocol::Endpoint& server, const ClientConfig& config);

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

  /// Begins a session, or goes on with one of a former connection: its views are open again. To be asked before all
  /// else. A server that is too old to keep sessions names none.
  Result<wire::Resumed> resume(const std::string& session);

  /// Bytes of the answers received so far.
  [[nodiscard]] uint64_t bytes_received() const { return bytes_received_; }
  /// An error that names the server.
  [[nodiscard]] tl::unexpected<Error> failed(ErrorKind kind, const std::string& what) const;
  /// The server's hello.
  [[nodiscard]] const protocol::Hello& server() const { return server_; }

 private:
  using Clock = std::chrono::steady_clock;

  ServerConnection(const protocol::Endpoint& server, const ClientConfig& config,
                   std::unique_ptr<MessageChannel> channel);
  Status exchange_hellos(Clock::time_point deadline);
  Status authenticate();
  [[nodiscard]] tl::unexpected<Error> failed(const Error& error) const { return failed(error.kind, error.message); }

  protocol::Endpoint endpoint_;
  ClientConfig config_;
  std::unique_ptr<MessageChannel> channel_;
  protocol::Hello server_;
  uint64_t bytes_received_ = 0;
  uint64_t last_id_ = 0;
};

/// Asks one thing over a connection of its own.
Result<wire::Answer> ask_server(const protocol::Endpoint& server, const ClientConfig& config, wire::Request request);

}  // namespace surfcast::client
