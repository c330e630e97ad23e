// Soak test of a server with many short client visits:
//   soak SERVERS_PROCESS_ID HOST:PORT/MODEL [SECONDS [CLIENTS_AT_ONCE [PERCENT]]]
// Half of the clients use WebSocket. They disconnect during a movement, a rest, or a picture. Fails when the mean
// memory of the server in the last quarter of the run is more than 2 % (or PERCENT) above that of the second quarter,
// when descriptors stay open, or when a visit fails.

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "base/stopwatch.h"
#include "client/bench_run.h"
#include "process_figures.h"

namespace surfcast::bench {
namespace {

struct SoakPlan {
  int process = 0;
  protocol::ModelUrl model;
  double seconds = 900;
  unsigned clients = 4;
  double percent = 2;  ///< permitted growth of memory
};

struct Sample {
  double seconds = 0;
  double megabytes = 0;
  int64_t descriptors = 0;
};

wire::DrawPicture small_picture(const std::string& model) {
  wire::DrawPicture picture;
  picture.set_model(model);
  picture.set_spacing(2);
  picture.mutable_resolution()->set_width(320);
  picture.mutable_resolution()->set_height(180);
  return picture;
}

/// One visit: a view that moves and rests for up to three seconds, or a picture request without waiting for the answer.
Status visit(const SoakPlan& plan, std::mt19937& random) {
  protocol::Endpoint server = plan.model.server;
  server.websocket = random() % 2 == 0;
  client::BenchPlan view;
  view.server = server;
  view.picture = small_picture(plan.model.model);
  view.seconds = 0.2 + static_cast<double>(random() % 3000) / 1000;
  view.move_seconds = 0.7;
  view.rest_seconds = 1.2;
  if (random() % 4 != 0) {
    const Result<client::BenchRecord> record =
        client::run_bench_client(view, {}, static_cast<double>(random() % 100) / 100);
    return record ? Status() : fail(record);
  }
  Result<client::ServerConnection> connection = client::ServerConnection::open(server, {});
  if (!connection) return fail(connection);
  wire::Request request;
  *request.mutable_draw_picture() = view.picture;
  const Result<uint64_t> sent = connection->send(std::move(request));
  return sent ? Status() : fail(sent);
}

double mean_of(const std::vector<Sample>& samples, double from, double to) {
  double sum = 0;
  double count = 0;
  for (const Sample& sample : samples) {
    if (sample.seconds < from || sample.seconds >= to) continue;
    sum += sample.megabytes;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

std::vector<Sample> watch(const SoakPlan& plan, const std::atomic<unsigned>& visits) {
  std::vector<Sample> samples;
  const Stopwatch watch;
  for (double next = 0; watch.seconds() < plan.seconds; next += plan.seconds / 60) {
    while (watch.seconds() < next) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    samples.push_back(
        {watch.seconds(), static_cast<double>(resident_bytes(plan.process)) / 1e6, open_descriptors(plan.process)});
    std::printf("%6.0f s  %8.1f MB  %4lld descriptors  %u visits\n", samples.back().seconds, samples.back().megabytes,
                static_cast<long long>(samples.back().descriptors), visits.load());
    std::fflush(stdout);
  }
  return samples;
}

/// The descriptors of the server once it has the model open.
int64_t descriptors_at_first(const SoakPlan& plan) {
  std::mt19937 random(plan.clients);
  if (!visit(plan, random)) std::fputs("the first visit failed\n", stderr);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  return open_descriptors(plan.process);
}

int soak(const SoakPlan& plan) {
  const int64_t descriptors_before = descriptors_at_first(plan);
  std::atomic<bool> over = false;
  std::atomic<unsigned> visits = 0;
  std::atomic<unsigned> failures = 0;
  std::vector<std::jthread> clients;
  for (unsigned i = 0; i < plan.clients; ++i) {
    clients.emplace_back([&, i] {
      std::mt19937 random(i);
      for (; !over; ++visits) failures += visit(plan, random) ? 0 : 1;
    });
  }
  const std::vector<Sample> samples = watch(plan, visits);
  over = true;
  clients.clear();
  std::this_thread::sleep_for(std::chrono::seconds(3));
  const int64_t kept = open_descriptors(plan.process) - descriptors_before;
  const double early = mean_of(samples, plan.seconds / 4, plan.seconds / 2);
  const double late = mean_of(samples, plan.seconds * 3 / 4, plan.seconds + 60);
  std::printf("%u visits, %u failed; %.1f MB in the second quarter, %.1f MB in the last: %+.2f %%; %+lld descriptors\n",
              visits.load(), failures.load(), early, late, 100 * (late / early - 1), static_cast<long long>(kept));
  return late > early * (1 + plan.percent / 100) || kept > 0 || failures > 0 ? 1 : 0;
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("soak SERVERS_PROCESS_ID HOST:PORT/MODEL [SECONDS [CLIENTS_AT_ONCE [PERCENT]]]\n", stderr);
    return 2;
  }
  const auto model = surfcast::protocol::parse_model_url(argv[2]);
  if (!model) {
    std::fprintf(stderr, "soak: %s\n", model.error().message.c_str());
    return 2;
  }
  surfcast::bench::SoakPlan plan{std::atoi(argv[1]), *model};
  if (argc > 3) plan.seconds = std::strtod(argv[3], nullptr);
  if (argc > 4) plan.clients = static_cast<unsigned>(std::strtoul(argv[4], nullptr, 10));
  if (argc > 5) plan.percent = std::strtod(argv[5], nullptr);
  return surfcast::bench::soak(plan);
}
