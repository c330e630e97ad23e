#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "base/stopwatch.h"

namespace surfcast {

/// Checked between the steps of long work: whether the work is cancelled, and whether more urgent work has to run first
/// on the same thread. Not thread-safe, except for the flag.
class Preemption {
 public:
  /// `cancelled` asks the work to stop soon. The flag must outlive this object.
  // NOLINTNEXTLINE(google-explicit-constructor): most callers have nothing but a flag
  Preemption(const std::atomic<bool>& cancelled) : cancelled_(&cancelled) {}
  /// `urgent` runs all work that must not wait and returns whether there was any.
  Preemption(const std::atomic<bool>& cancelled, std::function<bool()> urgent)
      : cancelled_(&cancelled), urgent_(std::move(urgent)) {}

  [[nodiscard]] bool cancelled() const { return cancelled_->load(std::memory_order_relaxed); }

  /// Runs urgent work first. True if there was any: state shared on this thread (the GL state, the list of load
  /// requests) may then have changed.
  [[nodiscard]] bool yield_to_urgent() const {
    if (!urgent_) return false;
    const Stopwatch watch;
    const bool preempted = urgent_();
    if (preempted) preempted_ms_ += watch.milliseconds();
    return preempted;
  }
  /// Milliseconds spent in urgent work.
  [[nodiscard]] double preempted_ms() const { return preempted_ms_; }

 private:
  const std::atomic<bool>* cancelled_;
  std::function<bool()> urgent_;
  mutable double preempted_ms_ = 0;
};

/// Measures the time of some work without the urgent work that preempted it.
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
