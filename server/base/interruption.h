#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "base/stopwatch.h"

namespace surfcast {

/// What may come between two steps of long work: that it is given up, or that something more urgent is done first on
/// the same thread. Used by that thread alone, but for the flag.
class Interruption {
 public:
  /// Work that stops soon after `cancelled`, which outlives this, becomes true.
  // NOLINTNEXTLINE(google-explicit-constructor): a flag is all that most work is interrupted by
  Interruption(const std::atomic<bool>& cancelled) : cancelled_(&cancelled) {}
  /// `urgent` does what must not wait, and returns whether there was anything.
  Interruption(const std::atomic<bool>& cancelled, std::function<bool()> urgent)
      : cancelled_(&cancelled), urgent_(std::move(urgent)) {}

  [[nodiscard]] bool cancelled() const { return cancelled_->load(std::memory_order_relaxed); }

  /// Lets what is more urgent go first. True if there was any: what the thread shares (the state of GL, what is on
  /// order) is then not what it was.
  [[nodiscard]] bool step_aside() const {
    if (!urgent_) return false;
    const Stopwatch watch;
    const bool disturbed = urgent_();
    if (disturbed) aside_ms_ += watch.milliseconds();
    return disturbed;
  }
  /// Milliseconds that others had.
  [[nodiscard]] double aside_ms() const { return aside_ms_; }

 private:
  const std::atomic<bool>* cancelled_;
  std::function<bool()> urgent_;
  mutable double aside_ms_ = 0;
};

/// Measures work without what was done in between.
class WorkStopwatch {
 public:
  explicit WorkStopwatch(const Interruption& interruption)
      : interruption_(interruption), aside_before_(interruption.aside_ms()) {}

  [[nodiscard]] double milliseconds() const {
    return watch_.milliseconds() - (interruption_.aside_ms() - aside_before_);
  }

 private:
  const Interruption& interruption_;
  double aside_before_;
  Stopwatch watch_;
};

}  // namespace surfcast
