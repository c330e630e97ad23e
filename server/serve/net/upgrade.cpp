#include "net/upgrade.h"

#include <algorithm>

#include "base/ascii_text.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

bool offers(std::string_view list, std::string_view protocol) {
  while (!list.empty()) {
    const size_t comma = std::min(list.find(','), list.size());
    std::string_view item = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    item.remove_prefix(std::min(item.find_first_not_of(" \t"), item.size()));
    if (item.substr(0, item.find_last_not_of(" \t") + 1) == protocol) return true;
  }
  return false;
}

/// The origin of the server's own pages.
std::string own_origin(const RequestOrigin& request) {
  const std::string_view scheme = request.scheme.empty() ? "http" : request.scheme;
  return std::string(scheme) + "://" + std::string(request.host);
}

bool allows(const RequestOrigin& request, std::span<const std::string> allowed) {
  if (request.origin.empty()) return true;
  if (!request.host.empty() && equal_in_any_case(request.origin, own_origin(request))) return true;
  return std::ranges::any_of(allowed, [&](const auto& other) { return equal_in_any_case(other, request.origin); });
}

}  // namespace

Status check_origin(const RequestOrigin& request, std::span<const std::string> allowed) {
  if (allows(request, allowed)) return {};
  return fail(ErrorKind::kInvalidInput, "pages of another origin may not connect; --allow-origin lets them");
}

Status check_upgrade(const UpgradeRequest& request, std::span<const std::string> allowed) {
  if (Status status = check_origin(request.from, allowed); !status) return status;
  if (!offers(request.protocols, protocol::kWebSocketProtocol)) {
    return fail(ErrorKind::kUnsupported,
                "a WebSocket here speaks the subprotocol " + std::string(protocol::kWebSocketProtocol) + " alone");
  }
  return {};
}

}  // namespace surfcast::net
