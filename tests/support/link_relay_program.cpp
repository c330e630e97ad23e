// link_relay LISTEN_PORT SERVER_PORT [MBIT_PER_SECOND [RTT_MS]]: emulates a network link of limited bandwidth between a
// client and a server on one machine. Runs until it is interrupted.

#include <charconv>
#include <csignal>
#include <cstdio>
#include <span>
#include <string_view>

#include "support/link_relay.h"

namespace {

double number(std::span<char*> arguments, size_t index, double otherwise) {
  if (index >= arguments.size()) return otherwise;
  const std::string_view text(arguments[index]);
  std::from_chars(text.data(), text.data() + text.size(), otherwise);
  return otherwise;
}

}  // namespace

int main(int argc, char** argv) {
  const std::span arguments(argv, static_cast<size_t>(argc));
  if (argc < 3) {
    std::fputs("link_relay LISTEN_PORT SERVER_PORT [MBIT_PER_SECOND [RTT_MS]]\n", stderr);
    return 2;
  }
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);  // the relay's threads inherit the mask
  surfcast::testing::LinkShape shape;
  shape.bits_per_second = number(arguments, 3, 4) * 1e6;
  shape.delay = std::chrono::microseconds(static_cast<int64_t>(number(arguments, 4, 80) * 500));
  const surfcast::testing::LinkRelay relay(static_cast<uint16_t>(number(arguments, 2, 0)), shape,
                                           static_cast<uint16_t>(number(arguments, 1, 0)));
  int ignored = 0;
  sigwait(&signals, &ignored);
  return 0;
}
