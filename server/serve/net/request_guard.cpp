#include "net/request_guard.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <utility>

#include "base/ascii_text.h"
#include "net/upgrade.h"

namespace surfcast::net {
namespace {

namespace ip = boost::asio::ip;

/// The host of "HOST" or "HOST:PORT". That of "[::1]:80" is "::1".
std::string_view without_port(std::string_view host) {
  if (!host.starts_with('[')) return host.substr(0, host.find(':'));
  const size_t end = host.find(']');
  if (end == std::string_view::npos) return host;
  const std::string_view rest = host.substr(end + 1);
  return rest.empty() || rest.front() == ':' ? host.substr(1, end - 1) : host;
}

bool is_address(std::string_view host) {
  boost::system::error_code code;
  ip::make_address(std::string(host), code);
  return !code;
}

std::optional<RequestRefusal> refusal_of_framing(const RequestHead& head) {
  const auto refuse = [](const char* why) { return RequestRefusal{400, {ErrorKind::kInvalidInput, why}}; };
  if (head.transfer_encodings == 0) return std::nullopt;
  if (head.version < 11) return refuse("HTTP/1.0 knows no Transfer-Encoding");
  if (head.content_length) return refuse("Transfer-Encoding and Content-Length exclude each other");
  if (head.transfer_encodings > 1 || !equal_in_any_case(head.transfer_encoding, "chunked")) {
    return refuse("the only Transfer-Encoding that is understood is chunked");
  }
  return std::nullopt;
}

std::optional<RequestRefusal> refusal_of_host(const RequestHead& head, std::span<const std::string> names) {
  if (head.hosts == 0 && head.version < 11) return std::nullopt;  // no browser; health checks of proxies
  if (head.hosts != 1 || head.host.empty()) {
    return RequestRefusal{400, {ErrorKind::kInvalidInput, "a request names its Host, once"}};
  }
  if (is_own_host(head.host, names)) return std::nullopt;
  return RequestRefusal{421, {ErrorKind::kInvalidInput, "this server has another name; --host gives it further ones"}};
}

/// A link that a user follows is no harm: the page that holds it sees nothing of the answer. Frames are none.
bool is_link(const RequestHead& head) {
  return head.get && head.fetch_mode == "navigate" && head.fetch_destination == "document";
}

std::optional<RequestRefusal> refusal_of_site(const RequestHead& head, const GuardConfig& config) {
  if (head.fetch_site != "cross-site" || is_link(head)) return std::nullopt;
  if (!head.origin.empty() && check_origin({head.host, head.origin, head.scheme}, config.allowed_origins)) {
    return std::nullopt;
  }
  return RequestRefusal{403,
                        {ErrorKind::kInvalidInput, "pages of other sites get no answers; --allow-origin lets them"}};
}

}  // namespace

bool is_own_host(std::string_view host, std::span<const std::string> names) {
  const std::string name = to_lower(without_port(host));
  if (name == "localhost" || name.ends_with(".localhost") || is_address(name)) return true;
  return std::ranges::any_of(names, [&](const std::string& own) { return own == "*" || equal_in_any_case(own, name); });
}

std::optional<RequestRefusal> refusal_of(const RequestHead& head, const GuardConfig& config) {
  if (auto refusal = refusal_of_framing(head)) return refusal;
  if (auto refusal = refusal_of_host(head, config.hosts)) return refusal;
  return refusal_of_site(head, config);
}

}  // namespace surfcast::net
