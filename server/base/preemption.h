#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "base/stopwatch.h"

namespace surfcast {

/// What may come between two steps of long work: that it is given up, or that something more urgent is done first on
/// the same thread. Used by that thread alone, but for the flag.
class Preemption {
 public:
  /// Work that stops soon after `cancelled`, which outlives this, becomes true.
  // NOLINTNEXTLINE(google-explicit-constructor): a flag is all that most work is interrupted by
  Preemption(const std::atomic<bool>& cancelled) : cancelled_(&cancelled) {}
  /// `urgent` does what must not wait, and returns whether there was anything.
  Preemption(const std::atomic<bool>& cancelled, std::function<bool()> urgent)
      : cancelled_(&cancelled), urgent_(std::move(urgent)) {}

  [[nodiscard]] bool cancelled() const { return cancelled_->load(std::memory_order_relaxed); }

  /// Lets what is more urgent go first. True if there was any: what the thread shares (the state of GL, what is on
  /// order) is then not what it was.
  [[nodiscard]] bool yield_to_urgent() const {
    if (!urgent_) return false;
    const Stopwatch watch;
    const bool preempted = urgent_();
    if (preempted) preempted_ms_ += watch.milliseconds();
    return preempted;
  }
  /// Milliseconds that others had.
  [[nodiscard]] double preempted_ms() const { return preempted_ms_; }

 private:
  const std::atomic<bool>* cancelled_;
  std::function<bool()> urgent_;
  mutable double preempted_ms_ = 0;
};

/// Measures work without what was done in between.
class WorkStopwatch {
 public:
  explicit WorkStopwatch(const Preemption& preemption)
      : preemption_(preemption), preempted_before_(preemption.preempted_ms()) {}

  [[nodiscard]] double milliseconds() const {
    return watch_.milliseconds() - (preemption_.preempted_ms() - preempted_before_);
  }

 private:
  const Preemption& preemption_;
  double preempted_before_;
  Stopwatch watch_;
};

}  // namespace surfcast
