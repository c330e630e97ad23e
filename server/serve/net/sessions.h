#pragma once

#include <functional>
#include <memory>

#include "net/connection.h"
#include "net/session.h"
#include "net/transport.h"

namespace surfcast::net {

/// Speaks the protocol of messages over any transport.
std::shared_ptr<Session> start_message_session(std::shared_ptr<Transport> transport, Peer peer);

/// Takes a session into the server's list of those that it drains when it stops.
using AdoptSession = std::function<void(const std::shared_ptr<Session>&)>;

/// A connection that speaks HTTP/1.1. A busy server answers 503 once and closes. A WebSocket is a new session, which
/// `adopt` gets.
std::shared_ptr<Session> start_http_session(Connection connection, AdoptSession adopt);

}  // namespace surfcast::net
