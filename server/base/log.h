#pragma once

#include <spdlog/spdlog.h>

namespace surfcast {

/// Sends the log to stderr as `PROGRAM: message`, so that stdout is free for pictures. Call once, at start-up.
void start_logging(const char* program);

}  // namespace surfcast
