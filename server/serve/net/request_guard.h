#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::net {

/// What of the head of an HTTP request decides whether it is answered at all. Empty: the header was not there.
struct RequestHead {
  unsigned version = 11;  ///< 10: HTTP/1.0
  bool get = true;        ///< GET or HEAD
  size_t hosts = 0;       ///< headers of that name
  std::string_view host;
  size_t transfer_encodings = 0;
  std::string_view transfer_encoding;
  bool content_length = false;
  std::string_view origin;
  std::string_view scheme;      ///< how the client has reached this server, or the proxy before it (X-Forwarded-Proto)
  std::string_view fetch_site;  ///< Sec-Fetch-Site and so on: what a browser says of the page that asks
  std::string_view fetch_mode;
  std::string_view fetch_destination;
};

/// Names and pages that the server answers to.
struct GuardConfig {
  std::span<const std::string> hosts;            ///< beside addresses and localhost; "*": any
  std::span<const std::string> allowed_origins;  ///< see check_origin
};

/// Why a request is refused.
struct RequestRefusal {
  unsigned status = 400;
  Error error;
};

/// The refusal of a request that
/// - could be taken for two (400; RFC 9112, 6.3): the next server on its way may see another end of it;
/// - names no host, or several (400; RFC 9112, 3.2);
/// - names a host that is not this server (421). A name of an attacker may lead here by DNS rebinding, and a browser
///   would then take the server's answers for those of the attacker's page. An address cannot be made to lead here;
/// - comes from a page of another site (403), unless its user follows a link, or its origin is allowed.
std::optional<RequestRefusal> refusal_of(const RequestHead& head, const GuardConfig& config);

/// Whether `host`, as in the header, with or without a port, is this server.
bool is_own_host(std::string_view host, std::span<const std::string> names);

}  // namespace surfcast::net
