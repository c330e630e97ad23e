#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "net/clients.h"
#include "net/request_window.h"
#include "net/static_files.h"
#include "net/uploads.h"
#include "service/render_service.h"
#include "view/view_session.h"

namespace surfcast::net {

struct ServerConfig {
  std::string host = "127.0.0.1";
  uint16_t port = 7600;  ///< 0: any free one
  ClientLimits clients;
  RequestWindow::Limits requests;                           ///< of one connection of the framed protocol
  size_t views = 8;                                         ///< open at a time on one connection
  double target_fps = 30;                                   ///< of views in motion whose client does not say
  size_t unread_bytes = size_t{64} << 20;                   ///< of answers; beyond it the connection is not read from
  size_t kept_frame_bytes = view::ViewSession::kKeptBytes;  ///< see ViewSession
  size_t request_bytes = size_t{64} << 10;    ///< of one message of a client; ours send no more than kMaxRequestBytes
  uint32_t http_header_bytes = 16384;         ///< of one request of HTTP
  std::chrono::milliseconds hello{10'000};    ///< for the first words of a connection
  std::chrono::milliseconds idle{300'000};    ///< without a whole request and with nothing outstanding
  std::chrono::milliseconds stall{30'000};    ///< without any byte of an answer being taken
  std::chrono::milliseconds ping{30'000};     ///< without a word on a WebSocket, before the client is asked for one
  std::chrono::milliseconds drain{5'000};     ///< for what is outstanding when the server stops
  std::shared_ptr<const StaticFiles> viewer;  ///< served at "/"; null: a hint where to get one
  UploadConfig uploads;                       ///< scans that clients may send
  std::vector<std::string> allowed_origins;   ///< of pages that may open a WebSocket beside the viewer's own
};

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
