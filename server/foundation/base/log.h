#pragma once

#include <spdlog/spdlog.h>

namespace surfcast {

/// Sends the log to stderr, so that stdout stays free for pictures. Call once, at start-up.
void start_logging(const char* program);

}  // namespace surfcast
