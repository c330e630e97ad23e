#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::protocol {

/// The address of a server, and the transport that a client uses.
struct Endpoint {
  std::string host;  ///< name or address; without the brackets of IPv6
  uint16_t port = 0;
  bool websocket = false;  ///< connect by WebSocket; otherwise by the framed protocol over TCP
  bool encrypted = false;  ///< through TLS
};

/// Parses "HOST:PORT", optionally with the prefix "tcp://" or "ws://", or "tcps://" or "wss://" for TLS. An IPv6
/// address must be in brackets.
Result<Endpoint> parse_endpoint(std::string_view text);
/// "HOST:PORT" without a scheme; an IPv6 address is put in brackets.
std::string to_string(const Endpoint& endpoint);

/// A server and the name of a model on it.
struct ModelUrl {
  Endpoint server;
  std::string model;
};

/// Parses "HOST:PORT/MODEL", with the prefixes of parse_endpoint.
Result<ModelUrl> parse_model_url(std::string_view text);

}  // namespace surfcast::protocol
