#include "builder/build_forecast.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

namespace surfcast::builder {
namespace {

using StageShare = std::pair<std::string_view, double>;

/// Shares of the time of a build in one part; "counting" is a stage of builds in several, "copying blocks" of those
/// that add scans to a model.
constexpr std::array<StageShare, 7> kShares{{
    {"reading", 0.02},
    {"counting", 0.03},
    {"sorting points", 0.02},
    {"making surfels", 0.51},
    {"copying blocks", 0},
    {"writing blocks", 0.41},
    {"writing levels above", 0.01},
}};
/// The same for builds of volumes.
constexpr std::array<StageShare, 2> kVolumeShares{{{"measuring samples", 0.15}, {"writing bricks", 0.85}}};
/// Beyond this share of a stage nothing is claimed that was not reported.
constexpr double kMaxByTime = 0.95;
/// The pace of a build is known once this share of it is done: reading alone says little.
constexpr double kKnownShare = 0.1;

std::span<const StageShare> shares_with(std::string_view stage) {
  const bool of_volumes = std::ranges::find(kVolumeShares, stage, &StageShare::first) != kVolumeShares.end();
  return of_volumes ? std::span<const StageShare>(kVolumeShares) : kShares;
}

double share_of(std::string_view stage) {
  for (const auto& [name, share] : shares_with(stage)) {
    if (name == stage) return share;
  }
  return 0;
}

/// The share of all stages before this one.
double share_before(std::string_view stage) {
  double sum = 0;
  for (const auto& [name, share] : shares_with(stage)) {
    if (name == stage) return sum;
    sum += share;
  }
  return 0;
}

}  // namespace

void BuildForecast::note(const BuildStep& step, double seconds) {
  if (step.stage != stage_) begin_stage(step, seconds);
  stage_done_ = step.done;
  if (step.points > 0) points_ = step.points;
}

void BuildForecast::begin_stage(const BuildStep& step, double seconds) {
  stage_ = step.stage;
  stage_share_ = share_of(stage_);
  before_ = std::max(before_, share_before(stage_));
  stage_began_ = seconds;
  if (before_ >= kKnownShare) seconds_per_share_ = seconds / before_;
}

double BuildForecast::expected_seconds() const {
  if (seconds_per_share_ > 0) return seconds_per_share_;
  return static_cast<double>(points_) / points_per_second_;
}

BuildOutlook BuildForecast::outlook(double seconds) {
  const double stage_seconds = expected_seconds() * stage_share_;
  const double by_time = stage_seconds > 0 ? std::min((seconds - stage_began_) / stage_seconds, kMaxByTime) : 0;
  const double in_stage = std::clamp(std::max(stage_done_, by_time), 0.0, 1.0);
  shown_ = std::max(shown_, std::min(before_ + stage_share_ * in_stage, 1.0));
  const double pace = std::max(expected_seconds(), shown_ >= kKnownShare ? seconds / shown_ : 0.0);
  return {stage_, shown_, pace * (1 - shown_)};
}

}  // namespace surfcast::builder
