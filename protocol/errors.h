#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::wire {
class Error;
}

namespace surfcast::protocol {

/// Converts an error to its wire message. The text becomes one line of valid UTF-8, because protobuf strings must be
/// valid UTF-8.
void to_wire(const Error& error, wire::Error& message);
/// Converts a wire message to an error. An error code that this build does not know becomes kInternal.
Error from_wire(const wire::Error& message);

/// The name of an error kind in JSON and in logs: "not_found".
std::string_view name_of(ErrorKind kind);

/// `text` with every control character replaced by a space and every byte that is not valid UTF-8 by a question mark.
std::string clean_utf8(std::string_view text);

}  // namespace surfcast::protocol
