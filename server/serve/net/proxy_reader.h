#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <functional>
#include <memory>

#include "net/session.h"

namespace surfcast::net {

/// Takes a connection of a proxy, with the address of its client.
using AdmitClient = std::function<void(boost::asio::ip::tcp::socket, const boost::asio::ip::address&)>;

/// Reads what a trusted proxy says of the client (see proxy_header.h), then passes the connection on. One that begins
/// with something else is the proxy's own. Nothing that is wrong, or not there within `most`, is passed on.
std::shared_ptr<Session> start_proxy_reader(boost::asio::ip::tcp::socket socket, std::chrono::milliseconds most,
                                            AdmitClient admit);

}  // namespace surfcast::net
