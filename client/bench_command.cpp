#include <chrono>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "base/atomic_file.h"
#include "client/bench_report.h"
#include "client/bench_run.h"
#include "client/commands.h"
#include "client/time_limits.h"
#include "protocol/request_flags.h"

namespace surfcast::client {
namespace {

struct BenchCommand {
  std::string url;
  protocol::RequestFlags flags;
  TimeLimits limits;
  BenchPlan plan;
  unsigned clients = 1;
  unsigned silent = 0;
  std::string json;
};

/// Collects the results of parallel clients.
struct BenchResults {
  std::mutex mutex;
  std::vector<BenchRecord> records;
  Status status;  ///< the first failure

  void add(Result<BenchRecord> record) {
    const std::scoped_lock lock(mutex);
    if (record) {
      records.push_back(std::move(*record));
    } else if (status) {
      status = fail(record);
    }
  }
};

Result<std::vector<BenchRecord>> run_clients(const BenchCommand& command, const BenchPlan& plan, int interrupt) {
  BenchResults results;
  const ClientConfig config = command.limits.config(protocol::ModelUrl{plan.server, plan.picture.model()}, interrupt);
  BenchPlan silent = plan;
  silent.reads = false;
  {
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < command.silent; ++i) {
      // The server may disconnect a client that does not read, so its result is ignored.
      threads.emplace_back([&, i] { static_cast<void>(run_bench_client(silent, config, 0.5 + i)); });
    }
    for (unsigned i = 0; i < command.clients; ++i) {
      threads.emplace_back(
          [&, i] { results.add(run_bench_client(plan, config, static_cast<double>(i) / command.clients)); });
    }
  }
  if (!results.status) return fail(results.status);
  return std::move(results.records);
}

Status bench(const BenchCommand& command, int interrupt) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(command.url);
  if (!url) throw CLI::ValidationError(url.error().message);
  if (Status status = command.flags.check_view_flags(); !status) throw CLI::ValidationError(status.error().message);
  Result<wire::DrawPicture> picture = command.flags.view_request(url->model);
  if (!picture) return fail(picture);
  BenchPlan plan = command.plan;
  plan.server = url->server;
  plan.picture = std::move(*picture);
  const Result<std::vector<BenchRecord>> records = run_clients(command, plan, interrupt);
  if (!records) return fail(records);
  const BenchReport report = make_report(*records);
  std::cout << to_text(report) << std::flush;
  if (command.json.empty()) return {};
  const std::string text = to_json(report, command.url);
  return write_file_atomically(command.json, std::string_view(text));
}

}  // namespace

void add_bench_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<BenchCommand>();
  BenchPlan& plan = command->plan;
  CLI::App* sub = app.add_subcommand("bench", "Measure frame rate, latency and bytes of views that move and rest");
  sub->add_option("url", command->url, "HOST:PORT/MODEL or ws://HOST:PORT/MODEL")->required();
  sub->add_option("--clients", command->clients, "number of parallel clients (default 1)")
      ->check(CLI::Range(1U, 1000U));
  sub->add_option("--silent", command->silent, "number of additional clients that stop reading (default 0)")
      ->check(CLI::Range(0U, 1000U));
  sub->add_option("--seconds", plan.seconds, "seconds of the whole run (default 20)")->check(CLI::Range(0.1, 86400.0));
  sub->add_option("--move", plan.move_seconds, "seconds of one movement (default 4)")->check(CLI::Range(0.1, 3600.0));
  sub->add_option("--rest", plan.rest_seconds, "most seconds of one rest (default 5)")->check(CLI::Range(0.0, 3600.0));
  sub->add_option("--target-fps", plan.target_fps, "frames per second to hold while moving (default: the server's)")
      ->check(CLI::Range(0.0, 1000.0));
  sub->add_flag("--depth", plan.depth, "ask for the depth of frames, as clients that warp them do");
  sub->add_flag("--video", plan.video, "take frames in motion as a video in VP9 where the link is thin");
  sub->add_option("--json", command->json, "write the results to this file as JSON")->type_name("FILE");
  command->flags.add_view_flags_to(*sub);
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = bench(*command, interrupt); });
}

}  // namespace surfcast::client
