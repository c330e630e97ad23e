#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace surfcast::command_line {

/// The word that was probably meant: one of which `typed` is a prefix, or the one with the fewest edits. An edit
/// inserts, removes or replaces a letter, or swaps two adjacent ones. None if all words need more than two edits, or as
/// many as `typed` has letters.
std::optional<std::string> closest_word(std::string_view typed, std::span<const std::string> words);

/// The message for a command line that could not be parsed. CLI11 names the flag of a wrong value even if the value
/// came from the flag's environment variable; the message then names the variable instead.
std::string parse_failure(const CLI::App& app, const std::string& message, int argc, const char* const* argv);

}  // namespace surfcast::command_line
