#include <memory>

#include "client/commands.h"
#include "client/time_limits.h"
#include "protocol/request_flags.h"
#include "protocol/save_picture.h"

namespace surfcast::client {
namespace {

struct RenderCommand {
  std::string url;
  protocol::RequestFlags flags;
  TimeLimits limits;
};

Status render(const RenderCommand& command, int interrupt) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(command.url);
  if (!url) throw CLI::ValidationError(url.error().message);
  if (Status status = command.flags.check(); !status) throw CLI::ValidationError(status.error().message);
  const Result<wire::DrawPicture> picture = command.flags.request(url->model);
  if (!picture) return fail(picture);
  Result<ServerConnection> connection = ServerConnection::open(url->server, command.limits.config(*url, interrupt));
  if (!connection) return fail(connection);
  return protocol::draw_and_save(command.flags, *picture, [&](const wire::DrawPicture& wanted) {
    wire::Request request;
    *request.mutable_draw_picture() = wanted;
    return connection->ask(std::move(request)).map([](wire::Answer answer) {
      return std::move(*answer.mutable_picture());
    });
  });
}

}  // namespace

void add_render_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = app.add_subcommand("render", "Draw a picture of a model on a server");
  sub->add_option("url", command->url, "HOST:PORT/MODEL or ws://HOST:PORT/MODEL")->required();
  command->flags.add_to(*sub);
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = render(*command, interrupt); });
}

}  // namespace surfcast::client
