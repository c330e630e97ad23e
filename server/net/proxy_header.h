#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::net {

// What a proxy says before the words of a client, of whose address it tells: version 2 of the PROXY protocol
// (haproxy.org, doc/proxy-protocol.txt, 2.2).

/// A connection that begins with another byte has no such header. No protocol of this server begins with it.
inline constexpr std::byte kProxyByte{0x0d};
/// Of the part that tells how long the rest is.
inline constexpr size_t kProxyHeadBytes = 16;

/// The bytes after the head; an error: this is none, or is longer than anybody needs.
Result<size_t> proxy_rest_bytes(std::span<const std::byte> head);

/// The address of the client. Nothing: the proxy speaks for itself, to see whether the server lives.
Result<std::optional<boost::asio::ip::address>> client_of_proxy(std::span<const std::byte> head,
                                                                std::span<const std::byte> rest);

/// Networks by their addresses, "10.0.0.0/8" or "fd00::/8"; an address alone is a network of one.
class Networks {
 public:
  static Result<Networks> parse(const std::vector<std::string>& texts);
  [[nodiscard]] bool contain(const boost::asio::ip::address& address) const;

 private:
  struct Network {
    boost::asio::ip::address_v6 address;  ///< IPv4 as mapped
    unsigned bits = 0;                    ///< of it that count
  };
  std::vector<Network> networks_;
};

}  // namespace surfcast::net
