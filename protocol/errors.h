#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::wire {
class Error;
}

namespace surfcast::protocol {

/// How an error travels; the message is made one line of valid UTF-8, as protobuf demands of its strings.
void to_wire(const Error& error, wire::Error& message);
/// An error code that this build does not know counts as kInternal.
Error from_wire(const wire::Error& message);

/// The name of a kind in JSON and in logs: "not_found".
std::string_view name_of(ErrorKind kind);

/// `text` with every control character as a space and every byte that is not valid UTF-8 as a question mark.
std::string clean_utf8(std::string_view text);

}  // namespace surfcast::protocol
