#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "service/client_shares.h"

namespace surfcast::service {

/// The origin of a job: all jobs of a connection have the same session.
using SessionId = uint64_t;
using JobId = uint64_t;

/// A client, and the connection by which it asks.
struct Client {
  Client() = default;
  /// A connection whose client has no other.
  Client(SessionId only_session) : id(only_session), session(only_session) {}  // NOLINT(google-explicit-constructor)
  Client(ClientId of_client, SessionId of_session) : id(of_client), session(of_session) {}

  ClientId id = 0;
  SessionId session = 0;
};

/// Motion pictures are urgent: a user is moving the view.
enum class Priority { kMotion, kStill };

/// The jobs that wait for the render thread. The client on which least time was spent comes first (see ClientShares),
/// and among clients with the same time that which has waited longest for its turn; its sessions take turns, one job
/// each. So a client that requests a thousand pictures, on however many connections, delays another one by at most one
/// picture. Jobs of the same session and priority keep their order. Not thread-safe.
class JobQueue {
 public:
  /// `limit`: jobs that may wait at a time, in all sessions and both priorities together. An eighth of them is for
  /// others than any one client.
  explicit JobQueue(size_t limit) : limit_(limit) {}

  /// False if the queue is full; the job is then not added.
  [[nodiscard]] bool push(const Client& client, JobId job, Priority priority);
  /// Whether a job may be taken now.
  using Accepts = std::function<bool(JobId)>;
  std::optional<JobId> pop(Priority priority, const Accepts& accepts = {});
  /// The next job of another session than this one.
  std::optional<JobId> pop_of_others(Priority priority, const Client& client, const Accepts& accepts = {});
  /// The client whose job would be popped; none if there is no such job.
  [[nodiscard]] std::optional<ClientId> next_client(Priority priority, const Accepts& accepts = {}) const;
  [[nodiscard]] bool has_waiting(Priority priority) const { return !lines_[static_cast<size_t>(priority)].empty(); }
  /// False if the job is not in the queue.
  bool remove(JobId job);
  [[nodiscard]] bool contains(JobId job) const;
  [[nodiscard]] size_t size() const { return size_; }

  /// What was spent on clients. A job that has been popped counts until it is said to be done.
  ClientShares& shares() { return shares_; }
  [[nodiscard]] const ClientShares& shares() const { return shares_; }

 private:
  struct Line {
    Client client;
    std::deque<JobId> jobs;  ///< never empty between calls
  };

  using Lines = std::deque<Line>;  ///< in the order of the sessions' turns
  using AcceptsLine = std::function<bool(const Line&)>;
  [[nodiscard]] Lines::const_iterator next(const Lines& lines, const AcceptsLine& accepts) const;
  std::optional<JobId> take(Lines& lines, const Lines::const_iterator& place);
  [[nodiscard]] size_t waiting_of(ClientId client) const;

  size_t limit_;
  size_t size_ = 0;
  std::array<Lines, 2> lines_;  ///< by priority
  ClientShares shares_;
};

}  // namespace surfcast::service
