#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "base/result.h"
#include "worker/channel.h"
#include "worker/shared_board.h"

namespace surfcast::worker {

/// How a process has ended.
struct ProcessEnd {
  int exit_code = 0;  ///< if it ended by itself
  int signal = 0;     ///< that ended it; 0: none
};

/// "signal 11 (Segmentation fault)" or "exit code 1".
std::string text_of(const ProcessEnd& end);
/// Whether the process ended because of what it did. SIGKILL and SIGTERM come from outside.
bool is_its_own_fault(const ProcessEnd& end);

/// A child process, with this end of its channel and the memory that it shares. The destructor kills it.
class WorkerProcess {
 public:
  /// `command`: the program and its arguments, which calls run_worker with kWorkerSocket and kWorkerMemory.
  /// `environment`: "NAME=value" of variables that it gets beside those of worker_environment().
  static Result<WorkerProcess> start(const std::vector<std::string>& command,
                                     const std::vector<std::string>& environment, size_t pixel_bytes);
  WorkerProcess(WorkerProcess&& other) noexcept;
  WorkerProcess& operator=(WorkerProcess&& other) noexcept;
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess();

  [[nodiscard]] Channel& channel() { return channel_; }
  [[nodiscard]] const SharedBoard& board() const { return board_; }
  [[nodiscard]] pid_t id() const { return id_; }
  /// Waits for the end of a process that has closed its channel, and kills it if it does not end soon.
  ProcessEnd end();

 private:
  WorkerProcess(pid_t id, Channel channel, SharedBoard board);

  pid_t id_ = -1;
  Channel channel_;
  SharedBoard board_;
};

}  // namespace surfcast::worker
