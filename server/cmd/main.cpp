#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>

#include "base/log.h"
#include "base/result.h"
#include "base/unfinished_file.h"
#include "cmd/build.h"
#include "cmd/inspect.h"
#include "cmd/pick.h"
#include "cmd/render.h"
#include "cmd/serve.h"

namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongCommandLine = 2;

int report(const std::string& message, int code) {
  std::cerr << "surfcastd: " << message << '\n';
  return code;
}

int run(int argc, char** argv) {
  CLI::App app{"Builds models from scans, inspects them, draws them, and serves them to clients", "surfcastd"};
  app.require_subcommand(1);
  surfcast::Status outcome;
  surfcast::cmd::add_build_command(app, outcome);
  surfcast::cmd::add_inspect_command(app, outcome);
  surfcast::cmd::add_serve_command(app, outcome);
  surfcast::cmd::add_render_command(app, outcome);
  surfcast::cmd::add_pick_command(app, outcome);
  surfcast::cmd::add_healthcheck_command(app, outcome);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);  // --help
    return report(error.what(), kWrongCommandLine);
  }
  return outcome ? kDone : report(outcome.error().message, kFailed);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow any further is an error of the write
  surfcast::remove_unfinished_files_on_signals();
  try {
    surfcast::start_logging("surfcastd");
    return run(argc, argv);
  } catch (const std::exception& error) {  // out of memory, mostly
    return report(error.what(), kFailed);
  }
}
