#include "command_line/parse_command_line.h"

#include <algorithm>
#include <iostream>

#include "base/ascii_text.h"
#include "command_line/parse_failure.h"
#include "command_line/shell_completion.h"

namespace surfcast::command_line {
namespace {

/// The error message if no command was given or found; none otherwise. `first` is the first argument, empty if there is
/// none.
std::optional<std::string> missing_command(const CommandSummary& program, const std::string& first) {
  const std::vector<std::string> names = command_names(program);
  if (names.empty() || first.starts_with('-') || std::ranges::find(names, first) != names.end()) return std::nullopt;
  const std::string hint = "; the commands are " + joined(names, ", ") + " (" + program.name + " --help)";
  if (first.empty()) return "a command is missing" + hint;
  const std::optional<std::string> closest = closest_word(first, names);
  const std::string question = closest ? " (did you mean '" + *closest + "'?)" : "";
  return "there is no command '" + first + "'" + question + hint;
}

/// Adds the flags that print an answer. They end the parsing with CLI::Success, as CLI11's own --help does.
void add_answers(CLI::App& app, const ProgramText& text) {
  app.set_version_flag("--version", text.name + " " SURFCAST_VERSION, "Print the version and exit");
  app.add_option_function<std::string>(
         "--completion",
         [&app, &text](const std::string& shell) {
           std::cout << shell_completion(summarize_command(app), text.name, *parse_shell(shell));
           throw CLI::Success();
         },
         "Print a script that completes command lines in a shell, and exit")
      ->type_name("SHELL")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  app.add_flag_callback(
         "--manual",
         [&app, &text] {
           std::cout << manual_page(summarize_command(app), text.name, SURFCAST_VERSION, text.manual);
           throw CLI::Success();
         },
         "Print the manual page in troff and exit")
      ->group("");
}

}  // namespace

std::optional<int> parse_command_line(CLI::App& app, const ProgramText& text, int argc, char** argv) {
  add_answers(app, text);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& answered) {  // --help and --version print here
    return app.exit(answered);
  } catch (const CLI::ParseError& error) {
    const std::string first = argc > 1 ? argv[1] : "";
    const std::string failure = parse_failure(app, error.what(), argc, argv);
    return report_failure(text, missing_command(summarize_command(app), first).value_or(failure), kWrongCommandLine);
  }
  return std::nullopt;
}

int report_failure(const ProgramText& text, const std::string& message, int code) {
  std::cerr << text.speaker << ": " << message << '\n';
  return code;
}

}  // namespace surfcast::command_line
