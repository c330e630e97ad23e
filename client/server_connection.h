#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"
#include "protocol/endpoint.h"
#include "protocol/framing.h"
#include "protocol/hello.h"
#include "surfcast.pb.h"

namespace surfcast {

struct ClientConfig {
  std::chrono::milliseconds connect{10'000};  ///< for the connection and both hellos
  std::chrono::milliseconds answer{120'000};  ///< for one whole answer
  int interrupt = -1;                         ///< descriptor that becomes readable when waiting should end; -1: none
};

/// A connection to a server, hellos exchanged. Blocking, with a limit on every wait. Errors name the server.
class ServerConnection {
 public:
  static Result<ServerConnection> open(const Endpoint& server, const ClientConfig& config);

  ServerConnection(ServerConnection&& other) noexcept;
  ServerConnection& operator=(ServerConnection&&) = delete;
  ~ServerConnection();

  /// Sends a request under a fresh id, which it returns.
  Result<uint64_t> send(wire::Request request);
  /// The next answer, whatever its id. kCancelled when interrupted.
  Result<wire::Answer> receive();
  /// Sends a request and waits for its answer; an answer that is an error is the error. When interrupted, the server is
  /// told to give the request up.
  Result<wire::Answer> ask(wire::Request request);

  /// What the server said of itself.
  [[nodiscard]] const Hello& server() const { return server_; }

 private:
  using Clock = std::chrono::steady_clock;

  ServerConnection(int descriptor, const Endpoint& server, const ClientConfig& config);
  Status exchange_hellos(Clock::time_point deadline);
  Status wait(short events, Clock::time_point deadline) const;
  Status write_all(std::span<const std::byte> bytes, Clock::time_point deadline);
  Result<size_t> read_some(std::span<std::byte> bytes, Clock::time_point deadline);
  Status read_all(std::span<std::byte> bytes, Clock::time_point deadline);
  [[nodiscard]] tl::unexpected<Error> failed(ErrorKind kind, const std::string& what) const;

  int descriptor_;
  Endpoint endpoint_;
  ClientConfig config_;
  Hello server_;
  FrameSplitter splitter_{kMaxAnswerBytes};
  uint64_t last_id_ = 0;
};

}  // namespace surfcast
