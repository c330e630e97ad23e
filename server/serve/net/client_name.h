#pragma once

#include <boost/asio/ip/address.hpp>
#include <string>

namespace surfcast::net {

/// What counts as one client: an IPv4 address, also one that is mapped into IPv6, or the /64 network of an IPv6
/// address, of which a single machine may use every address.
std::string client_name(const boost::asio::ip::address& address);

/// Whether it is an address of this machine for itself, also one that is mapped into IPv6.
bool is_loopback(const boost::asio::ip::address& address);

}  // namespace surfcast::net
