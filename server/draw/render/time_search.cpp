#include "render/time_search.h"

#include <algorithm>
#include <cmath>

#include "base/contract.h"
#include "render/time_goal.h"

namespace surfcast::render {
namespace {

constexpr double kFirst = 4;        // pixels: about the fastest pictures
constexpr double kFinestTry = 0.1;  // pixels: a finer spacing is the finest level
constexpr double kCoarsestTry = 8;  // pixels: coarser pictures are not faster
constexpr size_t kMaxTries = 7;

double surfels_at(double spacing) {
  return 1 / (spacing * spacing);
}

}  // namespace

double first_spacing_for(const std::optional<SpacingTime>& known, double milliseconds) {
  if (!known) return kFirst;
  return std::clamp(known->spacing * std::sqrt(known->milliseconds / (kAimedTime * milliseconds)), 2 * kFinestTry,
                    kFirst);
}

TimeSearch::TimeSearch(double milliseconds) : asked_(milliseconds) {}

void TimeSearch::add(const SpacingTime& point) {
  points_.push_back(point);
  std::ranges::sort(points_, {}, &SpacingTime::spacing);
}

bool TimeSearch::fits(const SpacingTime& point) const {
  return point.milliseconds <= kLongTime * asked_;
}

SpacingTime TimeSearch::best() const {
  SURFCAST_EXPECTS(!points_.empty());
  const SpacingTime fastest = *std::ranges::min_element(points_, {}, &SpacingTime::milliseconds);
  const double limit = kLongTime * std::max(asked_, fastest.milliseconds);
  return *std::ranges::find_if(points_, [&](const auto& point) { return point.milliseconds <= limit; });
}

std::optional<double> TimeSearch::next() const {
  const SpacingTime found = best();
  if (points_.size() >= kMaxTries) return std::nullopt;
  if (!fits(found)) return towards_faster();
  if (found.milliseconds >= kShortTime * asked_ || found.spacing == 0) return std::nullopt;
  const auto at = std::ranges::find(points_, found.spacing, &SpacingTime::spacing);
  return at == points_.begin() ? finer() : between(*std::prev(at), *at);
}

/// A step beyond the best point on a side where there is none. None if it lies between others.
std::optional<double> TimeSearch::towards_faster() const {
  constexpr double kStep = 1.6;
  constexpr size_t kMaxSlow = 4;  // tries, each of which takes longer than asked
  if (points_.back().spacing < kFirst) return kFirst;
  if (points_.size() >= kMaxSlow) return std::nullopt;
  const double fastest = best().spacing;
  if (fastest == points_.front().spacing && fastest / kStep >= kFinestTry) return fastest / kStep;
  if (fastest == points_.back().spacing && kStep * fastest <= kCoarsestTry) return kStep * fastest;
  return std::nullopt;
}

std::optional<double> TimeSearch::finer() const {
  constexpr double kFarthest = 4;
  const SpacingTime& end = points_.front();
  double spacing = end.spacing / 2;
  if (points_.size() > 1 && points_[0].milliseconds > points_[1].milliseconds) {
    spacing = std::clamp(solve(points_[0], points_[1]), end.spacing / kFarthest, end.spacing / 1.1);
  }
  return spacing < kFinestTry ? 0 : spacing;
}

std::optional<double> TimeSearch::between(const SpacingTime& fine, const SpacingTime& coarse) const {
  constexpr double kSame = 1.05;
  const double from = fine.spacing > 0 ? fine.spacing : std::min(kFinestTry, coarse.spacing / kSame);
  if (coarse.spacing <= kSame * from) return std::nullopt;
  const double solved = fine.spacing > 0 ? solve(fine, coarse) : std::sqrt(from * coarse.spacing);
  const double octaves = std::log2(coarse.spacing / from);
  return from * std::exp2(std::clamp(std::log2(solved / from), 0.1 * octaves, 0.9 * octaves));
}

/// The spacing of the time that is aimed at, on the curve through two points.
double TimeSearch::solve(const SpacingTime& fine, const SpacingTime& coarse) const {
  const double slope =
      (fine.milliseconds - coarse.milliseconds) / (surfels_at(fine.spacing) - surfels_at(coarse.spacing));
  const double surfels = surfels_at(coarse.spacing) + (kAimedTime * asked_ - coarse.milliseconds) / slope;
  return surfels > 0 ? 1 / std::sqrt(surfels) : 2 * coarse.spacing;
}

}  // namespace surfcast::render
