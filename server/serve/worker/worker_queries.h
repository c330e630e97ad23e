#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/log_format.h"
#include "base/result.h"
#include "service/model_queries.h"
#include "service/pick_service.h"
#include "worker/supervisor.h"

namespace surfcast::worker {

struct QueryWorkerConfig {
  std::vector<std::string> command;  ///< starts a worker, see WorkerProcess::start
  LogFormat log_format = LogFormat::kText;
  bool sandbox = true;
  std::vector<std::string> readable;          ///< files and folders that the sandbox lets it read, beside libraries
  uint64_t memory = uint64_t{8} << 30;        ///< bytes that each may allocate; 0: no limit
  std::chrono::milliseconds silence{60'000};  ///< without a block or a word of an answer, before it is taken for hung
  std::chrono::milliseconds pause{2'000};     ///< between two looks at workers that are idle
  service::PickLimits limits;                 ///< threads and memory of picks
};

/// Answers in child processes, which read models that are files, opened here and passed on as descriptors. There is one
/// for each thread that picks, and one for everything else, so that a pick waits for no search. The first one for picks
/// is started now, the others when they are needed. A process that has ended is started again, and what it was asked is
/// asked again; a question that ends two processes fails, unless a block is to blame, which is then not read any more.
/// Points of regions that are on their way then fail. `counts` outlives the queries.
Result<std::unique_ptr<service::ModelQueries>> worker_queries(const QueryWorkerConfig& config, WorkerCounts& counts);

}  // namespace surfcast::worker
