#include "render/scale_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "render/time_goal.h"

namespace surfcast::render {
namespace {

constexpr double kFirstConstant = 0.1;   // of the time at full size, before another size has been measured
constexpr double kLeast = 0.125;         // scale
constexpr double kSameScale = 1.03;      // ratio of scales that are not told apart
constexpr double kLongestScaleStep = 3;  // ratio of scales
constexpr size_t kMostScales = 5;

}  // namespace

ScaleSearch::ScaleSearch(double milliseconds, double whole) : asked_(milliseconds), points_{{1, whole}} {}

void ScaleSearch::add(const ScaleTime& point) {
  points_.push_back(point);
  std::ranges::sort(points_, std::greater(), &ScaleTime::scale);
}

bool ScaleSearch::fits(const ScaleTime& point) const {
  return point.milliseconds <= kLongTime * asked_;
}

ScaleTime ScaleSearch::best() const {
  const auto found = std::ranges::find_if(points_, [&](const ScaleTime& point) { return fits(point); });
  return found == points_.end() ? points_.back() : *found;
}

std::optional<double> ScaleSearch::next() const {
  const ScaleTime& smallest = points_.back();
  if (fits(points_.front()) || points_.size() >= kMostScales) return std::nullopt;
  if (!fits(smallest)) {
    if (smallest.scale <= kLeast) return std::nullopt;
    const ScaleTime other =
        points_.size() == 1 ? ScaleTime{0, kFirstConstant * smallest.milliseconds} : points_[points_.size() - 2];
    return std::clamp(solve(smallest, other), std::max(kLeast, smallest.scale / kLongestScaleStep),
                      smallest.scale / kSameScale);
  }
  const ScaleTime found = best();
  const ScaleTime larger = *std::prev(std::ranges::find(points_, found.scale, &ScaleTime::scale));
  if (found.milliseconds >= kShortTime * asked_ || larger.scale <= kSameScale * kSameScale * found.scale)
    return std::nullopt;
  return std::clamp(solve(found, larger), kSameScale * found.scale, larger.scale / kSameScale);
}

/// The scale of the time that is aimed at, on the line through two points over the number of pixels; 0: there is none.
double ScaleSearch::solve(const ScaleTime& a, const ScaleTime& b) const {
  const double from = a.scale * a.scale;
  const double slope = (b.milliseconds - a.milliseconds) / (b.scale * b.scale - from);
  const double pixels = from + (kAimedTime * asked_ - a.milliseconds) / slope;
  return pixels > 0 ? std::sqrt(pixels) : 0;
}

}  // namespace surfcast::render
