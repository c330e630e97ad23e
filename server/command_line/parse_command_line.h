#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command_line/manual_page.h"

namespace surfcast::command_line {

// How every program ends.
constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongCommandLine = 2;

/// What a program is called, and what its manual says beyond its flags.
struct ProgramText {
  std::string name;     ///< of its file
  std::string speaker;  ///< with which its messages begin
  std::vector<ManualSection> manual;
};

/// Parses the command line, which runs the callbacks of its commands. Besides the flags of `app` it knows --version,
/// --completion SHELL and, hidden, --manual, the page in troff. Returns the program's exit code where there is nothing
/// left to do: something was printed, or the command line is wrong, of which one line on standard error has told.
std::optional<int> parse_command_line(CLI::App& app, const ProgramText& text, int argc, char** argv);

/// "SPEAKER: MESSAGE" on standard error; returns `code`.
int report_failure(const ProgramText& text, const std::string& message, int code);

}  // namespace surfcast::command_line
