#include <memory>

#include "client/commands.h"
#include "client/time_limits.h"
#include "protocol/request_flags.h"

namespace surfcast::client {
namespace {

struct PickCommand {
  std::string url;
  protocol::PickFlags flags;
  TimeLimits limits;
};

Status pick(const PickCommand& command, int interrupt) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(command.url);
  if (!url) throw CLI::ValidationError(url.error().message);
  if (Status status = command.flags.check(); !status) throw CLI::ValidationError(status.error().message);
  return command.flags.request(url->model)
      .and_then([&](wire::PickSurfel pick) {
        wire::Request request;
        *request.mutable_pick_surfel() = std::move(pick);
        return ask_server(url->server, command.limits.config(*url, interrupt), std::move(request));
      })
      .and_then([&](const wire::Answer& answer) { return command.flags.print(answer.pick_result()); });
}

}  // namespace

void add_pick_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<PickCommand>();
  CLI::App* sub = app.add_subcommand("pick", "Print the surfel at a pixel of a picture");
  sub->add_option("url", command->url, "HOST:PORT/MODEL or ws://HOST:PORT/MODEL")->required();
  command->flags.add_to(*sub);
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = pick(*command, interrupt); });
}

}  // namespace surfcast::client
