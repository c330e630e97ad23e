#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>

#include "net/transport.h"

namespace surfcast::net {

/// The framed protocol, on a connection whose first byte has been seen but not read. A longer message than
/// `request_bytes` is an error.
std::shared_ptr<Transport> make_framed_transport(boost::asio::ip::tcp::socket socket, size_t request_bytes);

}  // namespace surfcast::net
