#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "protocol/picture_fields.h"

namespace surfcast::protocol {

// What other languages and documents have of the table of picture fields.

/// A module of TypeScript: the plain options of the viewer's links, their texts and their values in messages.
std::string typescript_options();

/// A module of Python: the types of plain options, and how they are kept in messages.
std::string python_options();

/// The table of all options in Markdown.
std::string markdown_options();

/// `document` with the table between the two lines that mark its place.
Result<std::string> with_options(const std::string& document);

/// The names of a choice: "first|second|third".
std::vector<std::string_view> names_of_choice(std::string_view form);

/// The shortest text that is read as the same number.
std::string number_text(double number);

/// Columns of the files that are made.
inline constexpr size_t kLineWidth = 120;

/// A text in lines that have at most `width` columns, if its words have, each after `prefix`.
std::string wrapped(std::string_view text, std::string_view prefix, size_t width);

}  // namespace surfcast::protocol
