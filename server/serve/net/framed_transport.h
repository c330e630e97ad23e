#pragma once

#include <memory>

#include "net/client_stream.h"
#include "net/transport.h"

namespace surfcast::net {

/// The framed protocol, on a connection of which no more was read than `begun`. A longer message than `request_bytes`
/// is an error.
std::shared_ptr<Transport> make_framed_transport(ClientStream stream, Bytes begun, size_t request_bytes);

}  // namespace surfcast::net
