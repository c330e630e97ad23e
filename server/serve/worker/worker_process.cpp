#include "worker/worker_process.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/child_process.h"
#include "worker/run_worker.h"
#include "worker/worker_environment.h"

namespace surfcast::worker {
namespace {

tl::unexpected<Error> process_error(const std::string& what, int code) {
  return fail(ErrorKind::kIo, what + ": " + std::strerror(code));
}

/// A copy of a descriptor whose number is none of those that a worker gets.
Descriptor copy_above(const Descriptor& descriptor) {
  return Descriptor(::fcntl(descriptor.get(), F_DUPFD_CLOEXEC, kWorkerMemory + 1));
}

/// The variables of this process.
std::vector<std::string> own_variables() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
  return variables;
}

Result<pid_t> spawn(std::vector<std::string> command, const std::vector<std::string>& environment,
                    const Descriptor& socket, const Descriptor& memory) {
  std::vector<std::string> variables = worker_environment(own_variables(), environment);
  const std::vector<char*> arguments = pointers_to(command);
  const std::vector<char*> values = pointers_to(variables);
  const Descriptor its_socket = copy_above(socket);
  const Descriptor its_memory = copy_above(memory);
  if (!its_socket || !its_memory) return process_error("cannot copy a descriptor", errno);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, its_socket.get(), kWorkerSocket);
  ::posix_spawn_file_actions_adddup2(&actions, its_memory.get(), kWorkerMemory);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, kWorkerMemory + 1);
  // The signals that the server's threads block are not blocked in the worker.
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = -1;
  const int code = ::posix_spawn(&process, arguments[0], &actions, &attributes, arguments.data(), values.data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (code != 0) return process_error("cannot start " + command.front(), code);
  return process;
}

/// False if the process has not ended yet.
bool wait_for_end(pid_t process, int flags, int& status) {
  pid_t ended = 0;
  do {
    ended = ::waitpid(process, &status, flags);
  } while (ended < 0 && errno == EINTR);
  return ended != 0;
}

}  // namespace

std::string text_of(const ProcessEnd& end) {
  if (end.signal == 0) return "exit code " + std::to_string(end.exit_code);
  return "signal " + std::to_string(end.signal) + " (" + ::strsignal(end.signal) + ")";
}

bool is_its_own_fault(const ProcessEnd& end) {
  return end.signal != SIGKILL && end.signal != SIGTERM;
}

Result<WorkerProcess> WorkerProcess::start(const std::vector<std::string>& command,
                                           const std::vector<std::string>& environment, size_t pixel_bytes) {
  Result<SharedBoard> board = SharedBoard::create(pixel_bytes);
  if (!board) return fail(board);
  Result<std::pair<Channel, Channel>> ends = Channel::make_pair();
  if (!ends) return fail(ends);
  const Result<pid_t> process = spawn(command, environment, ends->second.socket(), board->memory());
  if (!process) return fail(process);
  return WorkerProcess(*process, std::move(ends->first), std::move(*board));
}

WorkerProcess::WorkerProcess(pid_t id, Channel channel, SharedBoard board)
    : id_(id), channel_(std::move(channel)), board_(std::move(board)) {}

WorkerProcess::WorkerProcess(WorkerProcess&& other) noexcept
    : id_(std::exchange(other.id_, -1)), channel_(std::move(other.channel_)), board_(std::move(other.board_)) {}

WorkerProcess& WorkerProcess::operator=(WorkerProcess&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(channel_, other.channel_);
  std::swap(board_, other.board_);
  return *this;
}

WorkerProcess::~WorkerProcess() {
  if (id_ < 0) return;
  ::kill(id_, SIGKILL);
  int status = 0;
  wait_for_end(id_, 0, status);
}

ProcessEnd WorkerProcess::end() {
  constexpr int kPatienceMs = 500;  // a process that crashes closes its channel before it is gone
  int status = 0;
  bool ended = false;
  for (int i = 0; i < kPatienceMs && !ended; ++i) {
    ended = wait_for_end(id_, WNOHANG, status);
    if (!ended) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!ended) {
    ::kill(id_, SIGKILL);
    wait_for_end(id_, 0, status);
  }
  id_ = -1;
  if (WIFSIGNALED(status)) return {0, WTERMSIG(status)};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 0, 0};
}

}  // namespace surfcast::worker
