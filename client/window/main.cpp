#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <string>

#include "client/time_limits.h"
#include "client/window/view_loop.h"
#include "client/window/window.h"
#include "command_line/parse_command_line.h"
#include "protocol/request_flags.h"
#include "protocol/validate.h"

namespace surfcast::window {
namespace {

/// The program is started as `surfcast view`, mostly, and speaks by that name.
const command_line::ProgramText& program_text() {
  static const command_line::ProgramText text{
      "surfcast-view", "surfcast", {{"KEYS", {std::string(kWindowHelp)}}, {"SEE ALSO", {"surfcast(1), surfcastd(1)"}}}};
  return text;
}

Result<ViewRequest> view_request_of(const std::string& address, const protocol::RequestFlags& flags) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(address);
  if (!url) return fail(url);
  if (Status status = flags.check_view_flags(); !status) return fail(status);
  Result<wire::DrawPicture> picture = flags.view_request(url->model);
  if (!picture) return fail(picture);
  if (!picture->has_resolution()) {
    picture->mutable_resolution()->set_width(protocol::kDefaultWidth);
    picture->mutable_resolution()->set_height(protocol::kDefaultHeight);
  }
  return ViewRequest{*url, std::move(*picture), 0};
}

int run(int argc, char** argv) {
  CLI::App app{std::string("Show a model in an interactive window\n") + kWindowHelp, "surfcast view"};
  std::string address;
  protocol::RequestFlags flags;
  client::TimeLimits limits;
  double target_fps = 0;
  app.add_option("url", address, "HOST:PORT/MODEL or ws://HOST:PORT/MODEL")->required();
  app.add_option("--target-fps", target_fps, "frames per second to hold while moving (default: the server's)")
      ->check(CLI::Range(0.0, 1000.0));
  flags.set_default("spacing", "1");  // every surfel would take seconds to draw
  flags.add_view_flags_to(app);
  limits.add_to(app);
  if (const auto code = command_line::parse_command_line(app, program_text(), argc, argv)) return *code;
  Result<ViewRequest> request = view_request_of(address, flags);
  if (!request)
    return command_line::report_failure(program_text(), request.error().message, command_line::kWrongCommandLine);
  request->target_fps = target_fps;
  const Status outcome = view_in_window(*request, limits.config(request->url, -1));
  return outcome ? command_line::kDone
                 : command_line::report_failure(program_text(), outcome.error().message, command_line::kFailed);
}

}  // namespace
}  // namespace surfcast::window

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  // `surfcast view` starts this program with these signals blocked (interrupt_descriptor()).
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_UNBLOCK, &signals, nullptr);
  try {
    return surfcast::window::run(argc, argv);
  } catch (const std::exception& error) {
    return surfcast::command_line::report_failure(surfcast::window::program_text(), error.what(),
                                                  surfcast::command_line::kFailed);
  }
}
