#pragma once

#include <chrono>
#include <optional>

namespace surfcast::net {

/// When to ask a silent client whether it is still there, and when to take it for gone. It has as long for its answer
/// as it may be silent, from when it was asked: time in which nobody looked, as on a machine that slept, does not count
/// against it.
class Heartbeat {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Step { kWait, kAsk, kGone };

  Heartbeat(std::chrono::milliseconds timeout, Clock::time_point now) : timeout_(timeout), heard_(now) {}

  /// Something has come from the client.
  void hear(Clock::time_point now) {
    heard_ = now;
    asked_.reset();
  }
  /// What is to be done; kAsk is said once.
  Step poll(Clock::time_point now) {
    if (asked_) return now - *asked_ >= timeout_ ? Step::kGone : Step::kWait;
    if (now - heard_ < timeout_) return Step::kWait;
    asked_ = now;
    return Step::kAsk;
  }

 private:
  std::chrono::milliseconds timeout_;
  Clock::time_point heard_;
  std::optional<Clock::time_point> asked_;
};

}  // namespace surfcast::net
