#pragma once

#include <memory>

#include "net/session.h"
#include "net/transport.h"

namespace surfcast::net {

/// Speaks the protocol of messages over any transport.
std::shared_ptr<Session> start_message_session(std::shared_ptr<Transport> transport, Peer peer);

}  // namespace surfcast::net
