#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace surfcast::service {

/// The origin of a job: all jobs of a connection have the same session.
using SessionId = uint64_t;
using JobId = uint64_t;

/// Motion pictures are urgent: a user is moving the view.
enum class Priority { kMotion, kStill };

/// The jobs that wait for the render thread. Sessions take turns, one job each. So a session that requests a thousand
/// pictures delays another one by at most one picture. Jobs of the same session and priority keep their order. Not
/// thread-safe.
class JobQueue {
 public:
  /// `limit`: jobs that may wait at a time, in all sessions and both priorities together.
  explicit JobQueue(size_t limit) : limit_(limit) {}

  /// False if the queue is full; the job is then not added.
  [[nodiscard]] bool push(SessionId session, JobId job, Priority priority);
  std::optional<JobId> pop(Priority priority);
  /// The next job of another session.
  std::optional<JobId> pop_of_others(Priority priority, SessionId session);
  [[nodiscard]] bool has_waiting(Priority priority) const { return !lines_[static_cast<size_t>(priority)].empty(); }
  /// False if the job is not in the queue.
  bool remove(JobId job);
  [[nodiscard]] bool contains(JobId job) const;
  [[nodiscard]] size_t size() const { return size_; }

 private:
  struct Line {
    SessionId session = 0;
    std::deque<JobId> jobs;  ///< never empty between calls
  };

  using Lines = std::deque<Line>;  ///< in the order of the sessions' turns
  std::optional<JobId> take(Lines& lines, const Lines::iterator& place);

  size_t limit_;
  size_t size_ = 0;
  std::array<Lines, 2> lines_;  ///< by priority
};

}  // namespace surfcast::service
