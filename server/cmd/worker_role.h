#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::cmd {

/// The argument of a program that `serve` starts to draw. Users do not call it.
inline constexpr const char* kRenderWorker = "render-worker";

/// The same of one that answers picks and the like.
inline constexpr const char* kQueryWorker = "query-worker";

/// The command that starts a worker with one of these arguments: this program itself.
Result<std::vector<std::string>> worker_command(const char* purpose);

/// If the program was started with one of these arguments: draws or answers for the server that has started it, and
/// ends with it. Otherwise returns.
void run_as_worker(int argc, char** argv);

}  // namespace surfcast::cmd
