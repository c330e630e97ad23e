#pragma once

#include <functional>
#include <memory>

#include "net/connection.h"

namespace surfcast::net {

/// Gets a connection whose protocol is known: the framed one, or HTTP.
using PassOn = std::function<void(Connection, bool framed)>;

/// Looks at the first byte of a connection, does the handshake of TLS if the client begins one, and passes the
/// connection on.
std::shared_ptr<Session> start_protocol_detector(Connection connection, PassOn pass_on);

}  // namespace surfcast::net
