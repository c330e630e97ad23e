#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "command_line/command_summary.h"

namespace surfcast::command_line {

enum class Shell { kBash, kZsh, kFish };

/// "bash", "zsh" or "fish".
std::optional<Shell> parse_shell(std::string_view name);

/// A shell script that completes the program's commands, flags and values; file names where any value is allowed.
/// `name` is the name of the program's file.
std::string shell_completion(const CommandSummary& program, const std::string& name, Shell shell);

}  // namespace surfcast::command_line
