#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::cmd {

/// The first argument of a program that `serve` starts to draw. Users do not call it.
inline constexpr const char* kRenderWorker = "render-worker";

/// The command that starts a render worker: this program itself.
Result<std::vector<std::string>> render_worker_command();

/// Draws for the server that has started this process, until that ends.
[[noreturn]] void run_render_worker();

}  // namespace surfcast::cmd
