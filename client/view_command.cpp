#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "client/commands.h"

namespace surfcast::client {
namespace {

/// Replaces this process by surfcast-view, which is in the same folder. It is a separate program, so that the thin
/// client does not link SDL.
Status become_window(std::vector<std::string> arguments) {
  std::error_code code;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", code).parent_path() / "surfcast-view";
  arguments.insert(arguments.begin(), program.string());
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  return fail(ErrorKind::kUnsupported, program.string() + ": the program with the window is not installed");
}

}  // namespace

void add_view_command(CLI::App& app, Status& outcome) {
  CLI::App* sub = app.add_subcommand("view", "Show a model in an interactive window (view --help)");
  sub->set_help_flag();
  sub->prefix_command();
  sub->callback([sub, &outcome] { outcome = become_window(sub->remaining()); });
}

}  // namespace surfcast::client
