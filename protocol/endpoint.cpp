#include "protocol/endpoint.h"

#include <optional>

#include "protocol/parse.h"

namespace surfcast {
namespace {

constexpr std::string_view kScheme = "tcp://";

std::string_view without_scheme(std::string_view text) {
  if (text.starts_with(kScheme)) text.remove_prefix(kScheme.size());
  return text;
}

}  // namespace

Result<Endpoint> parse_endpoint(std::string_view text) {
  const auto wrong = [text] {
    return fail(ErrorKind::kInvalidInput, "'" + std::string(text) + "': HOST:PORT is wanted");
  };
  const std::string_view address = without_scheme(text);
  const size_t colon = address.rfind(':');
  if (colon == std::string_view::npos) return wrong();
  std::string_view host = address.substr(0, colon);
  const std::optional<uint32_t> port = parse_unsigned(address.substr(colon + 1));
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  } else if (host.find_first_of(":[]") != std::string_view::npos) {
    return wrong();
  }
  if (host.empty() || host.find('/') != std::string_view::npos || !port || *port > 65535) return wrong();
  return Endpoint{std::string(host), static_cast<uint16_t>(*port)};
}

std::string to_string(const Endpoint& endpoint) {
  const bool ipv6 = endpoint.host.find(':') != std::string::npos;
  return (ipv6 ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

Result<ModelUrl> parse_model_url(std::string_view text) {
  const std::string_view address = without_scheme(text);
  const size_t slash = address.find('/');
  if (slash == std::string_view::npos || slash + 1 == address.size()) {
    return fail(ErrorKind::kInvalidInput, "'" + std::string(text) + "': HOST:PORT/MODEL is wanted");
  }
  const Result<Endpoint> server = parse_endpoint(address.substr(0, slash));
  if (!server) return fail(server.error());
  return ModelUrl{*server, std::string(address.substr(slash + 1))};
}

}  // namespace surfcast
