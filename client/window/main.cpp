#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>

#include "client/time_limits.h"
#include "client/window/view_loop.h"
#include "client/window/window.h"
#include "protocol/request_flags.h"
#include "protocol/validate.h"

namespace surfcast::window {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongCommandLine = 2;
constexpr double kUsualSpacing = 1;  // pixels

int report(const std::string& message, int code) {
  std::cerr << "surfcast: " << message << '\n';
  return code;
}

Result<ViewRequest> view_request_of(const std::string& address, const protocol::RequestFlags& flags) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(address);
  if (!url) return fail(url.error());
  if (Status status = flags.check_view_flags(); !status) return fail(status.error());
  Result<wire::DrawPicture> picture = flags.view_request(url->model);
  if (!picture) return fail(picture.error());
  if (!picture->has_resolution()) {
    picture->mutable_resolution()->set_width(protocol::kDefaultWidth);
    picture->mutable_resolution()->set_height(protocol::kDefaultHeight);
  }
  if (picture->spacing() == 0) picture->set_spacing(kUsualSpacing);
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
  flags.add_view_flags_to(app);
  limits.add_to(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);  // --help
    return report(error.what(), kWrongCommandLine);
  }
  Result<ViewRequest> request = view_request_of(address, flags);
  if (!request) return report(request.error().message, kWrongCommandLine);
  request->target_fps = target_fps;
  const Status outcome = view_in_window(*request, limits.config(-1));
  return outcome ? 0 : report(outcome.error().message, kFailed);
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
    return surfcast::window::report(error.what(), surfcast::window::kFailed);
  }
}
