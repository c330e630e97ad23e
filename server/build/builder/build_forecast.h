#pragma once

#include <string>

#include "builder/build_report.h"

namespace surfcast::builder {

/// How far a build is, and how long it will still take.
struct BuildOutlook {
  std::string stage;
  double done = 0;          ///< of the whole build, in [0, 1]; never falls
  double seconds_left = 0;  ///< 0 until the number of points is known
};

/// Turns the steps of a build into its outlook. The shares of the stages are those of measured builds. A stage that
/// reports no steps of its own advances with time, at the pace of the stages before it.
class BuildForecast {
 public:
  /// `points_per_second`: of a whole build, until the build's own pace is known.
  explicit BuildForecast(double points_per_second) : points_per_second_(points_per_second) {}

  /// A step at `seconds` since the build began.
  void note(const BuildStep& step, double seconds);
  [[nodiscard]] BuildOutlook outlook(double seconds);

 private:
  void begin_stage(const BuildStep& step, double seconds);
  [[nodiscard]] double expected_seconds() const;

  double points_per_second_;
  std::string stage_;
  double stage_share_ = 0;
  double stage_done_ = 0;         ///< as reported
  double stage_began_ = 0;        ///< seconds
  double before_ = 0;             ///< share of the stages before this one
  double seconds_per_share_ = 0;  ///< the build's own pace; 0: not known yet
  uint64_t points_ = 0;
  double shown_ = 0;
};

}  // namespace surfcast::builder
