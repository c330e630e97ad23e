#include "client/time_limits.h"

#include "protocol/request_flags.h"

namespace surfcast::client {
namespace {

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1e3));
}

}  // namespace

void TimeLimits::add_to(CLI::App& command) {
  command.add_option("--connect-timeout", connect, "timeout of connecting, seconds (default 10)")
      ->envname(protocol::environment_name("connect-timeout"))
      ->check(CLI::Range(0.001, 86400.0));
  command.add_option("--timeout", answer, "timeout of an answer, seconds (default 120)")
      ->envname(protocol::environment_name("timeout"))
      ->check(CLI::Range(0.001, 86400.0));
}

ClientConfig TimeLimits::config(int interrupt) const {
  return {.connect = milliseconds(connect), .answer = milliseconds(answer), .interrupt = interrupt};
}

}  // namespace surfcast::client
