#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>

#include "base/result.h"
#include "client/commands.h"
#include "client/interrupt.h"
#include "command_line/parse_command_line.h"

namespace {

const surfcast::command_line::ProgramText& program_text() {
  static const surfcast::command_line::ProgramText text{
      "surfcast", "surfcast", {{"SEE ALSO", {"surfcast-view(1), surfcastd(1)"}}}};
  return text;
}

int run(int argc, char** argv) {
  CLI::App app{"Client of a Surfcast server, which renders pictures of large scans", "surfcast"};
  app.require_subcommand(1);
  const int interrupt = surfcast::client::interrupt_descriptor();
  surfcast::Status outcome;
  surfcast::client::add_models_command(app, interrupt, outcome);
  surfcast::client::add_login_command(app, interrupt, outcome);
  surfcast::client::add_render_command(app, interrupt, outcome);
  surfcast::client::add_bench_command(app, interrupt, outcome);
  surfcast::client::add_pick_command(app, interrupt, outcome);
  surfcast::client::add_profile_command(app, interrupt, outcome);
  surfcast::client::add_export_command(app, interrupt, outcome);
  surfcast::client::add_view_command(app, outcome);
  surfcast::client::add_ping_command(app, interrupt, outcome);
  if (const auto code = surfcast::command_line::parse_command_line(app, program_text(), argc, argv)) return *code;
  if (outcome) return surfcast::command_line::kDone;
  return surfcast::command_line::report_failure(program_text(), outcome.error().message,
                                                surfcast::command_line::kFailed);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe on standard output becomes a write error
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {  // usually std::bad_alloc
    return surfcast::command_line::report_failure(program_text(), error.what(), surfcast::command_line::kFailed);
  }
}
