// Measures the server's memory for idle connections, which have exchanged hellos and send nothing more:
//   surfcastd serve ... --max-connections 3000 &
//   idle_bench SERVERS_PROCESS_ID HOST:PORT|ws://HOST:PORT [COUNT]
// Start a new server for every run, because a second run would reuse memory freed after the first one. A connection
// takes four descriptors of this program (see `ulimit -n`).

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "base/stopwatch.h"
#include "client/server_connection.h"
#include "process_figures.h"

namespace surfcast::bench {
namespace {

Status measure(int process, const protocol::Endpoint& server, size_t count) {
  std::vector<client::ServerConnection> connections;
  connections.reserve(count);
  const uint64_t before = resident_bytes(process);
  for (size_t i = 0; i < count; ++i) {
    Result<client::ServerConnection> connection = client::ServerConnection::open(server, {});
    if (!connection) return fail(connection);
    connections.push_back(std::move(*connection));
  }
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const uint64_t after = resident_bytes(process);
  const auto growth = static_cast<double>(after) - static_cast<double>(before);
  std::printf("%s: %zu connections, %.1f MiB before, %.1f MiB with them, %.1f KiB each\n",
              server.websocket ? "WebSocket" : "framed", count, static_cast<double>(before) / 1048576,
              static_cast<double>(after) / 1048576, growth / 1024 / static_cast<double>(count));
  return {};
}

int run(int process, const std::string& address, size_t count) {
  const Result<protocol::Endpoint> server = protocol::parse_endpoint(address);
  const Status status = server ? measure(process, *server, count) : fail(server);
  if (status) return 0;
  std::fprintf(stderr, "idle_bench: %s\n", status.error().message.c_str());
  return 1;
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("idle_bench SERVERS_PROCESS_ID HOST:PORT|ws://HOST:PORT [COUNT]\n", stderr);
    return 2;
  }
  return surfcast::bench::run(std::atoi(argv[1]), argv[2], argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 1000);
}
