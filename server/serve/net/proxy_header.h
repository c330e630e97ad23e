#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::net {

// What a proxy says before the words of a client, of whose address it tells: the PROXY protocol (haproxy.org,
// doc/proxy-protocol.txt). Version 1 is a line of text, which nginx sends; version 2 is binary.

enum class ProxyVersion { kNone, kText, kBinary };

/// Bytes that tell whether a connection begins with such a header. Each protocol of this server begins with more.
inline constexpr size_t kProxyProbeBytes = 6;
ProxyVersion proxy_version(std::span<const std::byte, kProxyProbeBytes> first);

/// The longest line of version 1, with its end.
inline constexpr size_t kMaxProxyLine = 107;
/// The address of the client by a line of version 1, without "\r\n". Nothing: the proxy does not know it.
Result<std::optional<boost::asio::ip::address>> client_of_proxy_line(std::string_view line);

/// Of the part of a header of version 2 that tells how long the rest is.
inline constexpr size_t kProxyHeadBytes = 16;

/// The bytes after the head; an error: this is none, or is longer than anybody needs.
Result<size_t> proxy_rest_bytes(std::span<const std::byte> head);

/// The address of the client by version 2. Nothing: the proxy speaks for itself, to see whether the server lives.
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
