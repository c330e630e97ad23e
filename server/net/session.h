#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "net/clients.h"
#include "net/metrics.h"
#include "net/server.h"
#include "service/render_service.h"
#include "service/worker_pool.h"

namespace surfcast::net {

/// What the sessions of a server share. Used on the thread of the sockets alone, but for the service.
struct NetContext {
  service::RenderService& service;
  ServerConfig config;
  Metrics metrics;
  uint64_t last_viewer = 0;                   ///< see PictureRequest::viewer
  bool draining = false;                      ///< no new requests; what is outstanding is finished
  std::map<std::string, uint64_t> uploads{};  ///< scans on their way by model, and the bytes kept for them
  /// Writes what arrives, so that no other connection waits for the disk. Null: nothing may be sent.
  std::shared_ptr<service::WorkerPool> disk =
      config.uploads.folder.empty() ? nullptr : std::make_shared<service::WorkerPool>(1);
  std::shared_ptr<Clients> clients = std::make_shared<Clients>(config.clients);
};

/// Who is at the other end.
struct Peer {
  std::shared_ptr<NetContext> context;
  Counted open;  ///< the connection
  service::SessionId id = 0;
  std::string refusal;  ///< why it is not served, which it is told before the connection ends; empty: it is served
};

/// An accepted connection.
struct Connection {
  boost::asio::ip::tcp::socket socket;
  Peer peer;
};

/// Somebody who looks after a connection.
class Session {
 public:
  virtual ~Session() = default;
  /// Ends the session as soon as what it has outstanding is answered.
  virtual void drain() = 0;
  /// Ends it now; jobs are cancelled.
  virtual void abort() = 0;
  /// Models may have newer editions.
  virtual void models_changed() {}
};

}  // namespace surfcast::net
