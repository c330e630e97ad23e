#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::net {

/// What of a request for a WebSocket decides whether it is granted; empty: the header was not there.
struct UpgradeRequest {
  std::string_view host;
  std::string_view origin;     ///< of the page, as the browser states it; programs state none
  std::string_view protocols;  ///< subprotocols that the client offers
};

/// Whether a page of that origin may talk to the server, see check_upgrade.
Status check_origin(std::string_view host, std::string_view origin, std::span<const std::string> allowed);

/// A page may talk to the server that it came from. Another one needs its origin ("https://example.org:8443") in
/// `allowed`: a browser would connect any page that its user happens to visit. kUnsupported: not our subprotocol;
/// kInvalidInput: not allowed.
Status check_upgrade(const UpgradeRequest& request, std::span<const std::string> allowed);

}  // namespace surfcast::net
