#pragma once

#include <string>

namespace CLI {
class App;
}

namespace surfcast::command_line {

/// The message for a command line that could not be parsed. CLI11 names the flag of a wrong value even if the value
/// came from the flag's environment variable; the message then names the variable instead.
std::string parse_failure(const CLI::App& app, const std::string& message, int argc, const char* const* argv);

}  // namespace surfcast::command_line
