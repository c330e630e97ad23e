#include "service/worker_pool.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "base/log.h"
#include "base/stopwatch.h"

namespace surfcast::service {
namespace {

/// A task that runs out of memory is lost, the server is not.
void run(const std::function<void()>& task) try { task(); } catch (const std::exception& error) {
  spdlog::error("unexpected: {}", error.what());
}

}  // namespace

WorkerPool::WorkerPool(unsigned threads, unsigned small_threads, size_t most_waiting) : most_waiting_(most_waiting) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(/*only_small=*/false); });
  for (unsigned i = 0; i < small_threads; ++i) threads_.emplace_back([this] { work(/*only_small=*/true); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
}

bool WorkerPool::has_room(ClientId client) const {
  if (tasks_.size() >= most_waiting_) return false;
  const auto of_client = std::ranges::count_if(tasks_, [client](const Task& task) { return task.client == client; });
  return static_cast<size_t>(of_client) < most_waiting_ - most_waiting_ / 8;
}

bool WorkerPool::post(std::function<void()> task, ClientId client, TaskSize size) {
  {
    const std::lock_guard lock(mutex_);
    if (!has_room(client)) return false;
    tasks_.push_back({client, size, std::move(task)});
    shares_.enter(client);
  }
  wake_.notify_all();  // one of the threads may not take it
  return true;
}

bool WorkerPool::comes_before(const Task& a, const Task& b) const {
  if (a.size != b.size) return a.size < b.size;
  return shares_.used(a.client) < shares_.used(b.client);
}

WorkerPool::Tasks::iterator WorkerPool::next(bool only_small) {
  auto best = tasks_.end();
  for (auto task = tasks_.begin(); task != tasks_.end(); ++task) {
    if (only_small && task->size != TaskSize::kSmall) continue;
    if (best == tasks_.end() || comes_before(*task, *best)) best = task;
  }
  return best;
}

void WorkerPool::work(bool only_small) {
  std::unique_lock lock(mutex_);
  for (;;) {
    auto place = tasks_.end();
    wake_.wait(lock, [&] {
      place = next(only_small);
      return stopping_ || place != tasks_.end();
    });
    if (place == tasks_.end()) return;
    Task task = std::move(*place);
    tasks_.erase(place);
    lock.unlock();
    const Stopwatch watch;
    run(task.run);
    task.run = nullptr;  // destroys the task's captures outside the lock
    const double taken = watch.milliseconds();
    lock.lock();
    shares_.charge(task.client, taken);
    shares_.leave(task.client);
  }
}

}  // namespace surfcast::service
