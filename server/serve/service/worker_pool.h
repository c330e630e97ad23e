#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

#include "service/client_shares.h"

namespace surfcast::service {

/// How long a task may take.
enum class TaskSize { kSmall, kLarge };

/// Threads that run tasks. Tasks of one client run in the order in which they were posted, small ones before large
/// ones; between clients that comes next on which least time was spent (see ClientShares). The destructor runs the
/// remaining tasks and then joins the threads.
class WorkerPool {
 public:
  /// `small_threads`: further threads for small tasks alone, so that these never wait for large ones. `most_waiting`:
  /// tasks that may wait; an eighth of them is for others than any one client.
  explicit WorkerPool(unsigned threads, unsigned small_threads = 0, size_t most_waiting = SIZE_MAX);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// May be called from any thread. The task must not throw. False if too many wait already; it is not run then.
  bool post(std::function<void()> task, ClientId client = 0, TaskSize size = TaskSize::kLarge);

 private:
  struct Task {
    ClientId client = 0;
    TaskSize size = TaskSize::kLarge;
    std::function<void()> run;
  };
  using Tasks = std::list<Task>;

  void work(bool only_small);
  [[nodiscard]] Tasks::iterator next(bool only_small);
  [[nodiscard]] bool comes_before(const Task& a, const Task& b) const;
  [[nodiscard]] bool has_room(ClientId client) const;

  const size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Tasks tasks_;  ///< in the order in which they were posted
  ClientShares shares_;
  bool stopping_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace surfcast::service
