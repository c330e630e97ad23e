#include "render/spacing_search.h"

#include <algorithm>
#include <cmath>

#include "base/contract.h"

namespace surfcast::render {
namespace {

/// What is aimed at above the error asked for, dB: the error is estimated from samples, and one that is too large is
/// worse than one that is too small.
constexpr double kReserve = 1;
constexpr double kTooLarge = 1;    // taken below the target, dB
constexpr double kTooSmall = 1.5;  // taken above it, dB
constexpr double kSlope = 10;      // dB for each doubling of the spacing: typical
constexpr double kLongestStep = 2;
constexpr double kShortestStep = 0.2;  // doublings
constexpr size_t kMaxPoints = 8;
constexpr double kFinest = 1.0 / 64;  // pixels: a finer spacing is the finest level
constexpr double kCoarsest = 256;     // pixels: nothing coarser looks like the model

double log_mean(double a, double b, double share) {
  return std::exp2(std::log2(a) + share * (std::log2(b) - std::log2(a)));
}

}  // namespace

double guessed_spacing(const SpacingGuess& guess, double decibels) {
  const double doublings = (guess.found.decibels - decibels - kReserve) / kSlope;
  return std::clamp(guess.found.spacing * std::exp2(doublings), 4 * kFinest, kCoarsest);
}

SpacingSearch::SpacingSearch(double decibels) : target_(std::min(decibels + kReserve, kSamePicture)) {}

void SpacingSearch::add(const SpacingError& point) {
  points_.push_back(point);
  std::ranges::sort(points_, {}, &SpacingError::spacing);
}

double SpacingSearch::miss(const SpacingError& point) const {
  const double above = point.decibels - target_;
  return above < 0 ? -2 * above : above;
}

SpacingError SpacingSearch::best() const {
  SURFCAST_EXPECTS(!points_.empty());
  return *std::ranges::min_element(points_, {}, [this](const SpacingError& point) { return miss(point); });
}

std::optional<double> SpacingSearch::next() const {
  const double above = best().decibels - target_;
  if ((above >= -kTooLarge && above <= kTooSmall) || points_.size() >= kMaxPoints) return std::nullopt;
  const auto coarse = std::ranges::find_if(points_, [this](const auto& point) { return point.decibels < target_; });
  if (coarse == points_.end()) {
    return points_.back().spacing >= kCoarsest ? std::nullopt : std::optional(beyond(points_.back()));
  }
  if (coarse == points_.begin()) return beyond(*coarse);
  return between(*std::prev(coarse), *coarse);
}

/// By linear interpolation over the logarithm of the spacing; in the middle where the curve is too steep for that.
std::optional<double> SpacingSearch::between(const SpacingError& fine, const SpacingError& coarse) const {
  constexpr double kSteep = 30;  // dB
  constexpr double kSame = 1.03;
  const double from = std::max(fine.spacing, kFinest);
  if (coarse.spacing < kSame * from) return std::nullopt;
  const double fall = fine.decibels - coarse.decibels;
  const double share = fall > kSteep ? 0.5 : (fine.decibels - target_) / fall;
  return log_mean(from, coarse.spacing, std::clamp(share, 0.1, 0.9));
}

/// By the typical slope. Finer than all that makes a difference is the spacing 0.
double SpacingSearch::beyond(const SpacingError& end) const {
  const double doublings = (end.decibels - target_) / kSlope;
  const double step = std::clamp(std::abs(doublings), kShortestStep, kLongestStep);
  const double spacing = end.spacing * std::exp2(std::copysign(step, doublings));
  return spacing < kFinest ? 0 : std::min(spacing, kCoarsest);
}

}  // namespace surfcast::render
