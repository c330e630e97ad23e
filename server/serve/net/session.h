#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/log.h"
#include "base/log_limit.h"
#include "net/audit_log.h"
#include "net/clients.h"
#include "net/gatekeeper.h"
#include "net/kept_sessions.h"
#include "net/metrics.h"
#include "net/server_config.h"
#include "service/render_service.h"
#include "service/worker_pool.h"

namespace boost::asio::ssl {
class context;
}

namespace surfcast::net {

/// What the sessions of a server share. Used on the thread of the sockets alone, but for the service.
struct NetContext {
  service::RenderService& service;
  ServerConfig config;
  Metrics metrics;
  uint64_t last_viewer = 0;                   ///< see PictureRequest::viewer
  bool leaving = false;                       ///< no longer ready: the server will stop
  bool draining = false;                      ///< no new requests; what is outstanding is finished
  std::map<std::string, uint64_t> uploads{};  ///< files on their way by key_of, and the bytes kept for them
  /// One thread that writes what arrives, so that no other connection waits for the disk. Null: nothing may be sent.
  std::shared_ptr<service::WorkerPool> disk = config.uploads.folder.empty() && config.annotations.folder.empty()
                                                  ? nullptr
                                                  : std::make_shared<service::WorkerPool>(1);
  std::shared_ptr<Clients> clients = std::make_shared<Clients>(config.clients);
  std::shared_ptr<Gatekeeper> gate = std::make_shared<Gatekeeper>(config.tokens);
  KeptSessions sessions{config.sessions};
  std::shared_ptr<AuditLog> audit{};  ///< null: none is kept
  LogLimit refused_lines{config.log_lines};
  LogLimit broken_lines{config.log_lines};
  LogLimit accept_lines{config.log_lines};
  std::shared_ptr<boost::asio::ssl::context> tls{};  ///< for connections that begin with it; null: none may
};

/// A line of a kind that strangers cause, if there were not too many of them lately.
void log_limited(LogLimit& limit, spdlog::level::level_enum level, const std::string& line);

/// Who is at the other end.
struct Peer {
  std::shared_ptr<NetContext> context;
  Counted open;  ///< the connection
  service::SessionId id = 0;
  /// By which the service knows the connection and its client.
  [[nodiscard]] service::Client client() const { return {client_id(open.client(), user), id}; }
  std::string refusal;      ///< why it is not served, which it is told before the connection ends; empty: it is served
  Gatekeeper::User user{};  ///< who it is, as far as it has said so; null: nobody
};

/// Somebody who looks after a connection.
class Session {
 public:
  virtual ~Session() = default;
  /// Ends the session as soon as what it has outstanding is answered.
  virtual void drain() = 0;
  /// It goes on until it is told: its client would come back elsewhere at once.
  [[nodiscard]] virtual bool lasts() const { return false; }
  /// Ends it now; jobs are cancelled.
  virtual void abort() = 0;
  /// The time for that is over: what is outstanding is given up with an answer that says so.
  virtual void give_up() { abort(); }
  /// Since when it is served and of no use: nothing is open, outstanding or on its way. Nothing if it is in use.
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> idle_since() const { return std::nullopt; }
  /// Whose it is, as in client_name; empty if that is not known yet.
  [[nodiscard]] virtual std::string client() const { return {}; }
  /// It is only told why it is not served.
  [[nodiscard]] virtual bool refused() const { return false; }
  /// Tokens may have been revoked, and time passes.
  virtual void check_user() {}
  /// Models may have newer editions.
  virtual void models_changed() {}
};

}  // namespace surfcast::net
