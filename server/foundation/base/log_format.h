#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace surfcast {

enum class LogFormat { kText, kJson };

/// The form of every line of the log from here on. JSON: one object a line,
/// {"time": "2027-01-31T12:00:00.123Z", "level": "info", "message": "..."}.
void set_log_format(LogFormat format);

/// A text as the value of a string of JSON, without the quotes. Control
/// characters and bytes that are not ASCII are escaped, so that no value can
/// end its line or its string; bytes that are not UTF-8 become U+FFFD.
std::string json_escaped(std::string_view text);

/// "2027-01-31T12:00:00.123Z" (RFC 3339, in UTC).
std::string utc_text(std::chrono::system_clock::time_point time);

}  // namespace surfcast
