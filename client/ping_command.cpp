#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>
#include <numeric>
#include <vector>

#include "base/stopwatch.h"
#include "client/commands.h"
#include "client/time_limits.h"

namespace surfcast::client {
namespace {

struct PingCommand {
  std::string url;
  unsigned count = 4;
  TimeLimits limits;
};

void print_summary(const std::vector<double>& times) {
  const auto [least, most] = std::ranges::minmax(times);
  const double mean = std::reduce(times.begin(), times.end()) / static_cast<double>(times.size());
  std::cout << times.size() << " round trips: min " << least << " ms, mean " << mean << " ms, max " << most << " ms\n";
}

Status ping(const PingCommand& command, int interrupt) {
  const Result<protocol::Endpoint> server = protocol::parse_endpoint(command.url);
  if (!server) throw CLI::ValidationError(server.error().message);
  Result<ServerConnection> connection = ServerConnection::open(*server, command.limits.config(*server, interrupt));
  if (!connection) return fail(connection);
  std::cout << std::fixed << std::setprecision(3);
  std::vector<double> times;
  for (unsigned i = 0; i < command.count; ++i) {
    const Stopwatch watch;
    wire::Request request;
    request.mutable_ping();
    const Result<wire::Answer> answer = connection->ask(std::move(request));
    if (!answer) return fail(answer);
    times.push_back(watch.milliseconds());
    std::cout << connection->server().program << ": " << times.back() << " ms\n";
  }
  print_summary(times);
  return {};
}

}  // namespace

void add_ping_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<PingCommand>();
  CLI::App* sub = app.add_subcommand("ping", "Measure the round trip time to a server");
  sub->add_option("url", command->url, "HOST:PORT or ws://HOST:PORT; with TLS tcps:// or wss://")->required();
  sub->add_option("--count", command->count, "number of round trips (default 4)")->check(CLI::Range(1U, 1000000U));
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = ping(*command, interrupt); });
}

}  // namespace surfcast::client
