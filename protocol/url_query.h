#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::protocol {

/// Decodes the percent escapes ("%2C") in part of a URL. A malformed escape or an escaped NUL is an error.
Result<std::string> decode_escapes(std::string_view text);
/// The reverse: all but letters, digits and "-._~" become escapes.
std::string encode_escapes(std::string_view text);

/// Sets the parameter `name` from its text.
using SetParameter = std::function<Status(const std::string& name, const std::string& text)>;

/// Calls `set` for each parameter of a query ("a=1&b=2"), with its escapes decoded. A parameter that is given twice, or
/// that `set` fails on, is kInvalidInput.
Status for_each_parameter(std::string_view query, const SetParameter& set);

}  // namespace surfcast::protocol
