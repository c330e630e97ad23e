#pragma once

#include <string>
#include <string_view>

namespace surfcast::access {

/// The secret of a new token: 32 bytes of the system's random numbers in 43 characters of base64url (RFC 4648, 5),
/// which stand in headers, subprotocols and cookies as they are.
std::string make_secret();

/// Whether a text could be a secret of make_secret. What could not is not looked up.
bool is_secret(std::string_view text);

/// SHA-256 of a text, 64 hexadecimal digits.
std::string sha256(std::string_view text);

}  // namespace surfcast::access
