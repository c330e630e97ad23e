#include "command_line/parse_failure.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <span>
#include <string_view>

namespace surfcast::command_line {
namespace {

/// Where a flag stands in a message as a word of its own.
size_t find_flag(const std::string& message, const std::string& flag) {
  const auto of_flag = [](unsigned char c) { return c == '-' || std::isalnum(c) != 0; };
  size_t place = message.find(flag);
  while (place != std::string::npos && place + flag.size() < message.size() && of_flag(message[place + flag.size()])) {
    place = message.find(flag, place + 1);
  }
  return place;
}

bool is_given(const CLI::Option& option, std::span<const char* const> arguments) {
  return std::ranges::any_of(arguments, [&](std::string_view argument) {
    return std::ranges::any_of(option.get_lnames(), [&](const std::string& name) {
      return argument.starts_with("--") && argument.substr(2, argument.find('=') - 2) == name;
    });
  });
}

bool is_from_environment(const CLI::Option& option, std::span<const char* const> arguments) {
  if (option.get_envname().empty() || is_given(option, arguments)) return false;
  const char* value = std::getenv(option.get_envname().c_str());
  return value != nullptr && *value != '\0';
}

}  // namespace

std::string parse_failure(const CLI::App& app, const std::string& message, int argc, const char* const* argv) {
  const std::span arguments(argv, static_cast<size_t>(argc));
  for (const CLI::App* command : app.get_subcommands()) {
    for (const CLI::Option* option : command->get_options()) {
      const std::string flag = option->get_name();
      const size_t place = find_flag(message, flag);
      if (place == std::string::npos || !is_from_environment(*option, arguments)) continue;
      return message.substr(0, place) + option->get_envname() + message.substr(place + flag.size());
    }
  }
  return message;
}

}  // namespace surfcast::command_line
