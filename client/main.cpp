#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>

#include "base/result.h"
#include "client/commands.h"
#include "client/interrupt.h"

namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongCommandLine = 2;

int report(const std::string& message, int code) {
  std::cerr << "surfcast: " << message << '\n';
  return code;
}

int run(int argc, char** argv) {
  CLI::App app{"Client of a Surfcast server, which renders pictures of large scans", "surfcast"};
  app.set_version_flag("--version", "surfcast " SURFCAST_VERSION);
  app.require_subcommand(1);
  const int interrupt = surfcast::client::interrupt_descriptor();
  surfcast::Status outcome;
  surfcast::client::add_models_command(app, interrupt, outcome);
  surfcast::client::add_render_command(app, interrupt, outcome);
  surfcast::client::add_bench_command(app, interrupt, outcome);
  surfcast::client::add_pick_command(app, interrupt, outcome);
  surfcast::client::add_view_command(app, outcome);
  surfcast::client::add_ping_command(app, interrupt, outcome);
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
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe on standard output becomes a write error
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {  // usually std::bad_alloc
    return report(error.what(), kFailed);
  }
}
