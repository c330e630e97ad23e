#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::protocol {

/// Where a server listens.
struct Endpoint {
  std::string host;  ///< name or address; without the brackets of IPv6
  uint16_t port = 0;
  bool websocket = false;  ///< a client talks to it by WebSocket; otherwise by the framed protocol
};

/// "HOST:PORT", perhaps after "tcp://" or "ws://"; an IPv6 address stands in brackets.
Result<Endpoint> parse_endpoint(std::string_view text);
/// The same way around, without a scheme; addresses of IPv6 get their brackets.
std::string to_string(const Endpoint& endpoint);

/// A server and a model of it.
struct ModelUrl {
  Endpoint server;
  std::string model;
};

/// "HOST:PORT/MODEL".
Result<ModelUrl> parse_model_url(std::string_view text);

}  // namespace surfcast::protocol
