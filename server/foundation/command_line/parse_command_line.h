#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command_line/manual_page.h"

namespace surfcast::command_line {

// Exit codes of all programs.
constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongCommandLine = 2;

/// The name of a program, and the sections of its manual beyond its flags.
struct ProgramText {
  std::string name;     ///< name of its file
  std::string speaker;  ///< prefix of its messages
  std::vector<ManualSection> manual;
};

/// Parses the command line, which runs the callbacks of its commands. Adds the flags --version, --completion SHELL, and
/// the hidden --manual, which prints the manual page for troff. Returns an exit code if nothing is left to do: an
/// answer was printed, or the command line is wrong and one line on standard error says so.
std::optional<int> parse_command_line(CLI::App& app, const ProgramText& text, int argc, char** argv);

/// Prints "SPEAKER: MESSAGE" on standard error; returns `code`.
int report_failure(const ProgramText& text, const std::string& message, int code);

}  // namespace surfcast::command_line
