#pragma once

#include <cstdint>
#include <memory>

#include "base/result.h"
#include "net/server_config.h"
#include "service/render_service.h"

namespace surfcast::net {

/// The listener and its connections: framed protocol, HTTP and WebSocket on one port. Everything happens on the thread
/// that calls `run`, and none of it waits for a picture or for a slow client.
class Server {
 public:
  /// Binds the port. `service` must outlive the server.
  static Result<std::unique_ptr<Server>> create(service::RenderService& service, const ServerConfig& config);
  ~Server();

  [[nodiscard]] uint16_t port() const;
  /// Serves until `stop` is called or, if asked for, SIGINT or SIGTERM arrives; then takes no more connections,
  /// finishes what is outstanding within ServerConfig::drain, and returns.
  void run(bool until_signal);
  /// From any thread.
  void stop();
  /// There is a newer edition of a model, which open views are to show. From any thread.
  void models_changed();

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::net
