#pragma once

#include <mutex>

#include "base/stopwatch.h"
#include "builder/build_report.h"

namespace surfcast::builder {

/// Reports the progress of consecutive stages and records the duration of each.
class StageClock {
 public:
  StageClock(const BuildProgress& progress, BuildReport& report) : progress_(progress), report_(report) {}
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;
  ~StageClock() { end(); }

  /// How many points the stages from now on work on.
  void know_points(uint64_t points) { points_ = points; }
  /// Ends the previous stage and begins one of `steps` steps.
  void begin(const char* stage, size_t steps) {
    end();
    stage_ = stage;
    steps_ = steps;
    done_ = 0;
    stopwatch_ = {};
    progress_({stage_, 0, points_});
  }
  /// Call when a step, or several, are complete. Thread-safe.
  void step(uint64_t steps = 1) {
    const std::lock_guard lock(mutex_);
    done_ += static_cast<size_t>(steps);
    progress_({stage_, static_cast<double>(done_) / static_cast<double>(steps_), points_});
  }

 private:
  void end() {
    if (stage_ != nullptr) report_.stages.emplace_back(stage_, stopwatch_.seconds());
    stage_ = nullptr;
  }

  const BuildProgress& progress_;
  BuildReport& report_;
  std::mutex mutex_;
  const char* stage_ = nullptr;
  size_t steps_ = 1;
  size_t done_ = 0;
  uint64_t points_ = 0;
  Stopwatch stopwatch_;
};

}  // namespace surfcast::builder
