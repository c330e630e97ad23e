#include <chrono>
#include <memory>
#include <string>

#include "client/server_connection.h"
#include "cmd/commands.h"
#include "cmd/settings.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

Status check_health(const protocol::Endpoint& server, std::chrono::milliseconds timeout) {
  wire::Request request;
  request.mutable_ping();
  return client::ask_server(server, {.connect = timeout, .answer = timeout}, std::move(request))
      .map([](const wire::Answer&) {});
}

}  // namespace

void add_healthcheck_command(CLI::App& app, Status& outcome) {
  auto url = std::make_shared<std::string>("127.0.0.1:7600");
  auto timeout = std::make_shared<std::chrono::milliseconds>(5000);
  CLI::App* sub = app.add_subcommand("healthcheck", "Check that a server answers; the exit code is 0 if it does");
  sub->add_option("--url", *url, "HOST:PORT of the server (default 127.0.0.1:7600)")
      ->envname(protocol::environment_name("listen"));
  add_seconds(
      *sub, "timeout", *timeout,
      "For the connection, and for the answer (default 5). More: a hung server is found later; less: a busy one "
      "counts as gone");
  sub->callback([url, timeout, &outcome] {
    const Result<protocol::Endpoint> server = protocol::parse_endpoint(*url);
    if (!server) throw CLI::ValidationError("--url", server.error().message);
    outcome = check_health(*server, *timeout);
  });
}

}  // namespace surfcast::cmd
