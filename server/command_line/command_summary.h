#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace surfcast::command_line {

/// A flag or a positional argument, as people are told of it.
struct OptionSummary {
  std::vector<std::string> names;    ///< with their dashes, short ones first; of a positional its one name
  std::string value;                 ///< what a value looks like; empty for a switch
  std::vector<std::string> choices;  ///< all values there are; empty: any
  std::string help;
  std::string variable;  ///< of the environment; empty: none
  bool positional = false;
  bool required = false;
  bool several = false;  ///< may be given more than once
};

/// A program or one of its commands.
struct CommandSummary {
  std::string name;
  std::string description;
  std::vector<OptionSummary> options;    ///< positionals, too; without those that --help hides
  std::vector<CommandSummary> commands;  ///< sorted by name
  bool forwards = false;                 ///< hands its arguments to another program as they are
};

/// What the definition of a command line says, as plain data for manual pages and completions.
CommandSummary summarize_command(const CLI::App& app);

/// The names of a program's commands.
std::vector<std::string> command_names(const CommandSummary& program);

}  // namespace surfcast::command_line
