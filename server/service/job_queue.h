#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace surfcast::service {

/// Who asks: all jobs of one connection share one.
using SessionId = uint64_t;
using JobId = uint64_t;

/// Whether somebody's hand waits for a picture.
enum class Priority { kMotion, kStill };

/// What the render thread does next. Sessions take turns, one job each, so that one that asks for a thousand pictures
/// delays another by one picture at most; the jobs of one session and priority keep their order. Not thread-safe.
class JobQueue {
 public:
  /// `limit`: jobs that may wait at a time, over all sessions and of either priority.
  explicit JobQueue(size_t limit) : limit_(limit) {}

  /// False when the queue is full; the job has not been taken then.
  [[nodiscard]] bool push(SessionId session, JobId job, Priority priority);
  std::optional<JobId> pop(Priority priority);
  [[nodiscard]] bool has_waiting(Priority priority) const { return !lines_[static_cast<size_t>(priority)].empty(); }
  /// False when the job does not wait here.
  bool remove(JobId job);
  [[nodiscard]] bool contains(JobId job) const;
  [[nodiscard]] size_t size() const { return size_; }

 private:
  struct Line {
    SessionId session = 0;
    std::deque<JobId> jobs;  ///< never empty between calls
  };

  using Lines = std::deque<Line>;  ///< in the order of their turns

  size_t limit_;
  size_t size_ = 0;
  std::array<Lines, 2> lines_;  ///< by priority
};

}  // namespace surfcast::service
