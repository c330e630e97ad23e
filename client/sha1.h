#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace surfcast::client {

/// SHA-1 (FIPS 180-4). A WebSocket's handshake is made with it; it protects nothing.
std::array<uint8_t, 20> sha1(std::string_view text);

/// Base 64 (RFC 4648), with padding.
std::string base64(std::string_view bytes);

}  // namespace surfcast::client
