#include "worker/worker_life.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <utility>

#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include "base/log.h"

namespace surfcast::worker {
namespace {

/// A restriction that fails otherwise than by being unknown ends the worker.
Status unless_unknown(const Status& restricted) {
  if (restricted) return {};
  if (restricted.error().kind != ErrorKind::kUnsupported) return restricted;
  spdlog::warn("the worker is less confined: {}", restricted.error().message);
  return {};
}

}  // namespace

void end_worker(int code) {
  std::_Exit(code);
}

SharedBoard begin_worker(Descriptor memory) {
  // The server says when to end, also when all processes of its terminal or unit get a signal.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // of the thread that started it, which lives as long as it is of use
  const rlimit no_cores{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_cores);
  Result<SharedBoard> board = SharedBoard::adopt(std::move(memory));
  if (board) return std::move(*board);
  spdlog::error("worker: {}", board.error().message);
  end_worker(EXIT_FAILURE);
}

Received next_message(Channel& channel) {
  using std::chrono::milliseconds;
  constexpr milliseconds kMoment{300};
  constexpr milliseconds kLong{60'000};
  for (milliseconds patience = kMoment;;) {
    Result<std::optional<Received>> received = channel.receive(patience);
    if (!received) end_worker(EXIT_SUCCESS);  // the server has ended
    if (received->has_value()) return std::move(**received);
    if (patience == kMoment) ::malloc_trim(0);
    patience = kLong;
  }
}

void answer_server(Channel& channel, const Message& message) {
  if (!channel.send(message)) end_worker(EXIT_SUCCESS);
}

void limit_memory(uint64_t bytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  bytes = 0;  // sanitizers reserve more memory than there is
#endif
  if (bytes == 0) return;
  const rlimit limit{bytes, bytes};
  ::setrlimit(RLIMIT_DATA, &limit);  // what a process allocates, but not the files that it maps
}

Status confine_files(const OpenFiles& files) {
  return unless_unknown(restrict_files(files));
}

Status confine_calls() {
  if (Status calls = unless_unknown(restrict_calls()); !calls) return calls;
  ::prctl(PR_SET_DUMPABLE, 0);
  return {};
}

}  // namespace surfcast::worker
