#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>

#include "base/log.h"
#include "base/result.h"
#include "base/unfinished_file.h"
#include "cmd/commands.h"
#include "cmd/worker_role.h"
#include "command_line/parse_command_line.h"

namespace {

const surfcast::command_line::ProgramText& program_text() {
  static const surfcast::command_line::ProgramText text{
      "surfcastd",
      "surfcastd",
      {{"FILES",
        {"~/.cache/surfcast: models that were built of scans; serve, render and pick use them again.",
         "../share/surfcast/viewer, seen from the program: the viewer that serve shows to browsers."}},
       {"SEE ALSO", {"surfcast(1), surfcast-view(1)"}}}};
  return text;
}

int run(int argc, char** argv) {
  CLI::App app{"Builds models from scans, inspects them, draws them, and serves them to clients", "surfcastd"};
  app.require_subcommand(1);
  surfcast::Status outcome;
  surfcast::cmd::add_build_command(app, outcome);
  surfcast::cmd::add_build_step_commands(app, outcome);
  surfcast::cmd::add_colorize_command(app, outcome);
  surfcast::cmd::add_export_command(app, outcome);
  surfcast::cmd::add_gpus_command(app, outcome);
  surfcast::cmd::add_inspect_command(app, outcome);
  surfcast::cmd::add_serve_command(app, outcome);
  surfcast::cmd::add_render_command(app, outcome);
  surfcast::cmd::add_pick_command(app, outcome);
  surfcast::cmd::add_healthcheck_command(app, outcome);
  surfcast::cmd::add_token_command(app, outcome);
  if (const auto code = surfcast::command_line::parse_command_line(app, program_text(), argc, argv)) return *code;
  if (outcome) return surfcast::command_line::kDone;
  return surfcast::command_line::report_failure(program_text(), outcome.error().message,
                                                surfcast::command_line::kFailed);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow any further is an error of the write
  std::signal(SIGPIPE, SIG_IGN);  // so is a pipe whose reader has gone, also that of the log
  surfcast::remove_unfinished_files_on_signals();
  try {
    surfcast::start_logging("surfcastd");
    surfcast::cmd::run_as_worker(argc, argv);
    return run(argc, argv);
  } catch (const std::exception& error) {  // out of memory, mostly
    return surfcast::command_line::report_failure(program_text(), error.what(), surfcast::command_line::kFailed);
  }
}
