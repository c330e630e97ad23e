#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace surfcast {

// nlohmann::json instantiates its parser and its writer in every source that calls them, for seconds of compilation
// each. Here they are instantiated once.

/// The document of a text. If the text is not JSON, `is_discarded` is true and the document is of no other type.
[[nodiscard]] nlohmann::json parse_json_text(std::string_view text);

/// The same with the members of objects in the order of the text.
[[nodiscard]] nlohmann::ordered_json parse_ordered_json_text(std::string_view text);

/// The text of a document with `indent` spaces for each level, in one line if it is negative. Bytes that are not UTF-8,
/// as names of files may hold, are replaced (U+FFFD).
[[nodiscard]] std::string json_text(const nlohmann::json& document, int indent = -1);
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& document, int indent = -1);

}  // namespace surfcast
