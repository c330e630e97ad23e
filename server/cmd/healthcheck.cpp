#include <chrono>
#include <memory>
#include <string>

#include "client/server_connection.h"
#include "cmd/serve.h"
#include "cmd/settings.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

Status check_health(const protocol::Endpoint& server, std::chrono::milliseconds timeout) {
  Result<client::ServerConnection> connection =
      client::ServerConnection::open(server, {.connect = timeout, .answer = timeout});
  if (!connection) return fail(connection.error());
  wire::Request request;
  request.mutable_ping();
  const Result<wire::Answer> answer = connection->ask(std::move(request));
  if (!answer) return fail(answer.error());
  return {};
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
