#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <chrono>
#include <memory>

#include "net/connection.h"
#include "net/transport.h"

namespace surfcast::net {

/// The framed protocol, on a connection of which no more was read than `begun`. A longer message than `request_bytes`
/// is an error.
std::shared_ptr<Transport> make_framed_transport(ClientStream stream, Bytes begun, size_t request_bytes);

/// The header of a request for a WebSocket.
using UpgradeHead = boost::beast::http::request<boost::beast::http::empty_body>;

/// A WebSocket, on a connection whose request for one has been read and is to be granted. The client is asked for a
/// sign of life when it gave none for `ping`, and is taken for gone when none came for twice that. A longer message
/// than `request_bytes` ends the WebSocket.
std::shared_ptr<Transport> make_websocket_transport(ClientStream stream, UpgradeHead head,
                                                    std::chrono::milliseconds ping, size_t request_bytes);

}  // namespace surfcast::net
