#include "net/session.h"

namespace surfcast::net {

void log_limited(LogLimit& limit, spdlog::level::level_enum level, const std::string& line) {
  const std::optional<size_t> left_out = limit.admit(LogLimit::Clock::now());
  if (!left_out) return;
  spdlog::log(level, "{}", line);
  if (*left_out > 0) spdlog::log(level, "{} lines like this one were left out before", *left_out);
}

}  // namespace surfcast::net
