#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <utility>

#include "net/metrics.h"
#include "net/server.h"
#include "service/render_service.h"

namespace surfcast::net {

/// What the sessions of a server share. Used on the thread of the sockets alone, but for the service.
struct NetContext {
  service::RenderService& service;
  ServerConfig config;
  Metrics metrics;
  uint64_t last_viewer = 0;  ///< see PictureRequest::viewer
  bool draining = false;     ///< no new requests; what is outstanding is finished
};

/// Counts a connection as open for as long as it lives.
class OpenConnection {
 public:
  explicit OpenConnection(std::shared_ptr<NetContext> context) : context_(std::move(context)) {
    ++context_->metrics.connections_open;
  }
  ~OpenConnection() {
    if (context_) --context_->metrics.connections_open;
  }
  OpenConnection(OpenConnection&&) = default;
  OpenConnection& operator=(OpenConnection&&) = delete;

 private:
  std::shared_ptr<NetContext> context_;
};

/// Who is at the other end. One that is `busy` came when there were too many, and is only told so.
struct Peer {
  std::shared_ptr<NetContext> context;
  OpenConnection open;
  service::SessionId id = 0;
  bool busy = false;
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
};

}  // namespace surfcast::net
