#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace surfcast::worker {

/// Whether a worker needs an environment variable: those of the system, of libraries and of drivers, and those that
/// begin with SURFCAST_WORKER_. A worker decodes bytes of strangers, so it gets none that may hold a secret.
bool is_for_worker(std::string_view name);

/// The environment of a worker: the variables of `inherited` ("NAME=value") that it needs, and those of `added` that
/// are not among them.
std::vector<std::string> worker_environment(const std::vector<std::string>& inherited,
                                            const std::vector<std::string>& added);

}  // namespace surfcast::worker
