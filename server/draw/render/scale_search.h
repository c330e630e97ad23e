#pragma once

#include <optional>
#include <vector>

namespace surfcast::render {

/// The time of drawing a picture at this render scale.
struct ScaleTime {
  double scale = 1;         ///< see PictureRequest::render_scale
  double milliseconds = 0;  ///< without loading blocks
};

/// Searches for the largest render scale at which a picture is drawn in a stated time. The time is taken as a constant,
/// and as much for each pixel.
class ScaleSearch {
 public:
  /// `milliseconds`: the time asked for. `whole`: the time of the picture at its own size, which is longer.
  ScaleSearch(double milliseconds, double whole);

  void add(const ScaleTime& point);
  /// The scale to measure next; none: the best point is good enough, or measuring goes on for too long.
  [[nodiscard]] std::optional<double> next() const;
  /// The largest scale that takes no more than a tenth more than asked; the smallest one if all take longer.
  [[nodiscard]] ScaleTime best() const;

 private:
  [[nodiscard]] bool fits(const ScaleTime& point) const;
  [[nodiscard]] double solve(const ScaleTime& a, const ScaleTime& b) const;

  double asked_;
  std::vector<ScaleTime> points_;  ///< by descending scale
};

}  // namespace surfcast::render
