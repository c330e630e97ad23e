#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::net {

/// Where a request comes from; empty: the header was not there.
struct RequestOrigin {
  std::string_view host;
  std::string_view origin;  ///< of the page, as the browser states it; programs state none
  std::string_view scheme;  ///< "https" where the server, or a proxy before it, speaks TLS
};

/// A page may talk to the server that it came from, by the same scheme. Another one needs its origin
/// ("https://example.org:8443") in `allowed`: a browser would connect any page that its user happens to visit.
Status check_origin(const RequestOrigin& request, std::span<const std::string> allowed);

/// What of a request for a WebSocket decides whether it is granted.
struct UpgradeRequest {
  RequestOrigin from;
  std::string_view protocols;  ///< subprotocols that the client offers
};

/// kUnsupported: not our subprotocol; kInvalidInput: check_origin fails.
Status check_upgrade(const UpgradeRequest& request, std::span<const std::string> allowed);

}  // namespace surfcast::net
