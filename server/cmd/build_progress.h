#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "base/stopwatch.h"
#include "builder/build_forecast.h"

namespace surfcast::cmd {

enum class ProgressStyle {
  kNone,
  kTerminal,  ///< one line on standard error that is rewritten
  kJson,      ///< lines on standard error: {"stage": "writing blocks", "done": 0.62, "seconds_left": 31.5}
};

/// Reports the outlook of a build several times a second until it is destroyed.
class BuildProgressReport {
 public:
  BuildProgressReport(ProgressStyle style, double points_per_second);
  ~BuildProgressReport();
  BuildProgressReport(const BuildProgressReport&) = delete;
  BuildProgressReport& operator=(const BuildProgressReport&) = delete;

  void note(const builder::BuildStep& step);

 private:
  void report();

  const ProgressStyle style_;
  Stopwatch since_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  builder::BuildForecast forecast_;
  std::string shown_;
  std::jthread thread_;  ///< last, so that it ends first
};

}  // namespace surfcast::cmd
