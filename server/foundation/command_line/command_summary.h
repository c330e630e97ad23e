#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace surfcast::command_line {

/// The documentation of a flag or positional argument.
struct OptionSummary {
  std::vector<std::string> names;    ///< with dashes, short names first; for a positional argument its one name
  std::string value;                 ///< placeholder of the value; empty for a switch
  std::vector<std::string> choices;  ///< all allowed values; empty: any
  std::string help;
  std::string variable;  ///< environment variable; empty: none
  bool positional = false;
  bool required = false;
  bool several = false;  ///< may be given more than once
};

/// A program or one of its commands.
struct CommandSummary {
  std::string name;
  std::string description;
  std::vector<OptionSummary> options;    ///< with positional arguments, without options that --help hides
  std::vector<CommandSummary> commands;  ///< sorted by name
  bool forwards = false;                 ///< passes its arguments to another program unchanged
};

/// The definition of a command line as plain data for manual pages and completions.
CommandSummary summarize_command(const CLI::App& app);

/// The names of a program's commands.
std::vector<std::string> command_names(const CommandSummary& program);

}  // namespace surfcast::command_line
