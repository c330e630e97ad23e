#include "protocol/endpoint.h"

#include <optional>

#include "protocol/parse.h"

namespace surfcast::protocol {
namespace {

constexpr std::string_view kFramed = "tcp://";
constexpr std::string_view kWebSocket = "ws://";
constexpr std::string_view kEncryptedFramed = "tcps://";
constexpr std::string_view kEncryptedWebSocket = "wss://";

std::string_view scheme_of(std::string_view text) {
  for (const std::string_view scheme : {kFramed, kWebSocket, kEncryptedFramed, kEncryptedWebSocket}) {
    if (text.starts_with(scheme)) return scheme;
  }
  return {};
}

}  // namespace

Result<Endpoint> parse_endpoint(std::string_view text) {
  const auto wrong = [text] {
    return fail(ErrorKind::kInvalidInput, "'" + std::string(text) + "': expected HOST:PORT");
  };
  const std::string_view scheme = scheme_of(text);
  const std::string_view address = text.substr(scheme.size());
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
  return Endpoint{std::string(host), static_cast<uint16_t>(*port),
                  /*websocket=*/scheme == kWebSocket || scheme == kEncryptedWebSocket,
                  /*encrypted=*/scheme == kEncryptedFramed || scheme == kEncryptedWebSocket};
}

std::string to_string(const Endpoint& endpoint) {
  const bool ipv6 = endpoint.host.find(':') != std::string::npos;
  return (ipv6 ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

Result<ModelUrl> parse_model_url(std::string_view text) {
  const size_t slash = text.find('/', scheme_of(text).size());
  if (slash == std::string_view::npos || slash + 1 == text.size()) {
    return fail(ErrorKind::kInvalidInput, "'" + std::string(text) + "': expected HOST:PORT/MODEL");
  }
  const Result<Endpoint> server = parse_endpoint(text.substr(0, slash));
  if (!server) return fail(server);
  return ModelUrl{*server, std::string(text.substr(slash + 1))};
}

}  // namespace surfcast::protocol
