#pragma once

#include <chrono>
#include <optional>

namespace surfcast {

/// When to ask a silent client whether it is still there, and when to take it for gone. It has as long for its answer
/// as it may be silent, from when it was asked: time in which nobody looked, as on a machine that slept, does not count
/// against it.
class Heartbeat {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Step { kWait, kAsk, kGone };

  Heartbeat(std::chrono::milliseconds patience, Clock::time_point now) : patience_(patience), heard_(now) {}

  /// Something has come from the client.
  void hear(Clock::time_point now) {
    heard_ = now;
    asked_.reset();
  }
  /// What is to be done; kAsk is said once.
  Step look(Clock::time_point now) {
    if (asked_) return now - *asked_ >= patience_ ? Step::kGone : Step::kWait;
    if (now - heard_ < patience_) return Step::kWait;
    asked_ = now;
    return Step::kAsk;
  }

 private:
  std::chrono::milliseconds patience_;
  Clock::time_point heard_;
  std::optional<Clock::time_point> asked_;
};

}  // namespace surfcast
